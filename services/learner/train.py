"""Fine-tune the high level on demonstrations and on everything that people said so far.

The third step of a round, in a process of its own: `python -m services.learner.train` reads a
job from its standard input and reports line by line (`process.py`). It only reads the store.
"""

import os
import sys
import threading
import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import closing, suppress

import numpy as np
import torch
from numpy.typing import NDArray

from services.learner.aggregate import Label, derive, sha256_labels
from services.learner.balance import balance
from services.learner.config import Recipe, TrainSettings
from services.learner.gate import Candidate, Figures, keep_aside, split
from services.learner.process import Job, Report
from services.learner.publish import announcement
from services.learner.spell import Spelling, canonical, spelling
from services.learner.store.sql import SqlStore
from services.learner.store.store import PolicyRecord, Round, Store
from services.learner.store.tensors import TensorFiles, unpack
from shared.errors import HldError, PolicyError, RefusedError
from shared.goals.language.bank import PhraseBank
from shared.messages.decision import Decision
from shared.messages.observation import Observation
from shared.policies import examples
from shared.policies.checkpoint import bundled
from shared.policies.examples import Examples
from shared.policies.fit import FitSettings, fit
from shared.policies.fit import agreement as heads_agreement
from shared.policies.high_level import HighLevel
from shared.telemetry import set_up

Progress = Callable[[float], None]


def fine_tune(
    round_: Round,
    store: Store,
    files: TensorFiles,
    demonstrations: Examples,
    progress: Progress,
) -> Candidate:
    """Make the candidate of a round; the same manifest and seed give the same one.

    Raises:
        PolicyError: a version is missing, or there is nothing to learn from.
    """
    began = time.monotonic()
    recipe = Recipe.model_validate(round_.manifest.settings)
    in_force = _record(store, round_.parent)
    history = store.history(round_.manifest)
    spell = spelling(history.rulings)
    labels = derive(history, recipe.labels, in_force.low_level_sha256)
    kept, held_out = split(labels, recipe.gate.held_out_share)
    replayed, aside = keep_aside(len(demonstrations), recipe.gate.retained)
    retained = demonstrations.take(aside)
    policy = open_version(in_force, files)
    before, knew = agreement(policy, held_out, store, spell), known(policy, retained)
    if recipe.train.start == "base":
        policy = open_version(_record(store, 0), files)
    bank, spelt = grow(policy.bank, labels)
    said = gather(balance(kept, recipe.balance), spelt, store) if kept else None

    def told(step: int, steps: int, loss: float) -> bool:
        del loss  # Unused.
        progress(step / steps)
        return True

    settings = _fit_settings(recipe.train, round_.seed)
    report = fit(policy.net, bank, demonstrations.take(replayed), said, settings, told)
    policy = HighLevel(policy.net, bank, policy.version)
    figures = Figures(
        labels=len(kept),
        labels_sha256=sha256_labels(labels),
        held_out=len(held_out),
        loss=report.loss if np.isfinite(report.loss) else None,
        finite=all(np.isfinite(array).all() for array in policy.tensors().values()),
        seconds=round(time.monotonic() - began, 3),
        before=before,
        after=agreement(policy, held_out, store, spell),
        retained=len(retained),
        retained_before=knew,
        retained_after=known(policy, retained),
    )
    return Candidate(
        tensors=tuple(files.add(name, array) for name, array in policy.tensors().items()),
        bank=bank.phrases,
        settings=policy.settings(),
        figures=figures,
    )


def open_version(record: PolicyRecord, files: TensorFiles) -> HighLevel:
    """A kept version, ready to be asked or trained."""
    tensors = {ref.name: unpack(ref, files.get(ref.sha256)) for ref in record.tensors}
    return HighLevel.build(announcement(record, record.epoch, "learner"), tensors)


def grow(bank: PhraseBank, labels: Sequence[Label]) -> tuple[PhraseBank, dict[str, str]]:
    """A bank that holds every label, and how it spells each.

    A phrase that nobody used before is added at the end: the head compares vectors, so it needs
    no new weights.
    """
    spelling = {canonical(phrase): phrase for phrase in reversed(bank.phrases)}
    for label in labels:
        if label.text not in spelling:
            bank = bank.add(label.text)
            spelling[label.text] = label.text
    return bank, spelling


def gather(labels: Sequence[Label], spelling: dict[str, str], store: Store) -> Examples:
    """The labelled decisions as the network reads them: what the high level saw, as it saw it."""
    seen = [*store.decisions(label.decision for label in labels)]
    looks = [[*_past(decision), decision.id] for decision in seen]
    shown = _shown((name for names in looks for name in names), store)
    number = {name: row for row, name in enumerate(shown)}
    rows = np.full((len(looks), max(map(len, looks))), -1)
    for row, names in zip(rows, looks, strict=True):
        row[len(row) - len(names) :] = [number.get(name, -1) for name in names]
    return Examples(
        images=np.stack([*shown.values()]),
        prompts=[decision.prompt for decision in seen],
        previous=[decision.previous for decision in seen],
        labels=[spelling[label.text] for label in labels],
        weights=np.array([label.weight for label in labels], np.float32),
        senses=np.stack([decision.arrays["proprioception"] for decision in seen]),
        looks=rows,
    )


def _past(decision: Decision) -> list[str]:
    """Ids of the earlier decisions whose pictures were shown with this one, oldest first."""
    return [f"{decision.episode}-{index}" for index in decision.past]


def _shown(ids: Iterable[str], store: Store) -> dict[str, NDArray[np.uint8]]:
    """The pictures of decisions by their ids; those that never arrived are missing."""
    shown = {}
    for id_ in dict.fromkeys(ids):
        with suppress(RefusedError):
            shown[id_] = np.array(next(iter(store.decisions([id_]))).arrays["images"])
    return shown


def agreement(
    policy: HighLevel, labels: Sequence[Label], store: Store, spell: Spelling
) -> float | None:
    """The share of labels that a policy proposes first; None where there are none.

    spell: as the labels are spelt, so that another wording of the same is no miss.
    """
    if not labels:
        return None
    seen = store.decisions(label.decision for label in labels)
    right = [
        spell(policy.propose(observation_of(decision), past_of(decision, store))[0].goal.text)
        == label.text
        for label, decision in zip(labels, seen, strict=True)
    ]
    return sum(right) / len(right)


def known(policy: HighLevel, demonstrated: Examples) -> float | None:
    """The share of demonstrated decisions that a policy's bank head takes rightly."""
    if not len(demonstrated):
        return None
    return heads_agreement(policy.net, policy.bank, demonstrated).bank


def past_of(decision: Decision, store: Store) -> list[NDArray[np.uint8]]:
    """The earlier pictures that the high level was shown, oldest first."""
    return [*_shown(_past(decision), store).values()]


def observation_of(decision: Decision) -> Observation:
    """What the high level saw when it took a decision; arrays of its own, as torch wants them."""
    return Observation(
        step=decision.step,
        prompt=decision.prompt,
        previous=decision.previous,
        arrays={name: np.array(array) for name, array in decision.arrays.items()},
    )


def _record(store: Store, number: int) -> PolicyRecord:
    record = store.version(number)
    if record is None:
        raise PolicyError(f"the store has no version number {number}")
    return record


def _fit_settings(settings: TrainSettings, seed: int) -> FitSettings:
    return FitSettings(
        steps=settings.steps,
        batch=settings.batch,
        lr=settings.lr,
        frozen_encoder=settings.frozen_encoder,
        correction_share=settings.correction_share,
        seed=seed,
    )


def main() -> None:
    """Do the job on standard input, and report on standard output."""
    lines = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)  # Whatever else is printed goes to the log.
    set_up("learner-training")
    job = Job.model_validate_json(sys.stdin.readline())
    threading.Thread(target=_end_with_learner, daemon=True).start()

    def tell(report: Report) -> None:
        lines.write(report.model_dump_json() + "\n")

    tell(_work(job, lambda share: tell(Report(progress=share))))


def _end_with_learner() -> None:
    os.read(0, 1)  # Returns when the learner is gone; nobody waits for the result then.
    os._exit(1)


def _work(job: Job, progress: Progress) -> Report:
    with closing(SqlStore(job.store)) as store:
        round_ = next(one for one in store.rounds() if one.number == job.round)
        settings = Recipe.model_validate(round_.manifest.settings).train
        os.nice(settings.nice)
        torch.set_num_threads(settings.threads)
        try:
            demonstrations = examples.load(job.demonstrations or bundled("demonstrations"))
            files = TensorFiles(job.tensors)
            candidate = fine_tune(round_, store, files, demonstrations, progress)
        except HldError as error:
            return Report(reason=str(error))
    return Report(progress=1.0, candidate=candidate)


if __name__ == "__main__":
    main()
