"""Fine-tune the high level on demonstrations and on everything that people said so far.

The third step of a round, in a process of its own: `python -m services.learner.train` reads a
job from its standard input and reports line by line (`process.py`). It only reads the store.
"""

import os
import sys
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import closing
from functools import cache
from pathlib import Path

import numpy as np
import torch

from services.learner.anchor import anchor
from services.learner.code import code_version
from services.learner.config import Recipe, TrainSettings
from services.learner.descent import descent
from services.learner.gate import Candidate, Figures
from services.learner.gather import (
    agreed,
    gather,
    known,
    meant,
    open_version,
    renew,
    unread,
)
from services.learner.held_out import fall_by_chance, keep_aside, split
from services.learner.labels.aggregate import Label, derive, sha256_labels
from services.learner.labels.balance import balance
from services.learner.labels.spell import spelling
from services.learner.process import Job, Report
from services.learner.rounds import check_sources
from services.learner.store.sql import SqlStore
from services.learner.store.store import History, PolicyRecord, Round, Store
from services.learner.store.tensors import TensorFiles
from services.learner.trials import policy_sha256
from shared.errors import HldError, PolicyError
from shared.intervals import mcnemar
from shared.messages.goal import LanguageGoal
from shared.policies import examples
from shared.policies.checkpoint import bundled, load_card
from shared.policies.examples import Examples
from shared.policies.fit import fit
from shared.policies.fitter import FitSettings
from shared.policies.high_level import HighLevel
from shared.policies.low_level import LowLevel
from shared.telemetry import set_up

Progress = Callable[[float], None]
Treatment = Callable[[Sequence[Label]], Sequence[Label]]
Meaning = Callable[[str], str | None]


def fine_tune(
    round_: Round,
    store: Store,
    files: TensorFiles,
    demonstrations: Examples,
    progress: Progress,
    under_way: Path | None = None,
    treat: Treatment | None = None,
    meaning: Meaning = lambda phrase: phrase,
) -> Candidate:
    """Make the candidate of a round; the same manifest and seed give the same one.

    under_way: file of what is being trained; a training that was cut off goes on from there.
    meaning: the command that the low level takes a phrase for, which is loaded when one is new.
    treat: what an experiment does to the labels that are learned from; nobody else does.

    Raises:
        PolicyError: a version is missing, or there is nothing to learn from.
    """
    began = time.monotonic()
    recipe = Recipe.model_validate(round_.manifest.settings)
    in_force = _record(store, round_.parent)
    history = store.history(round_.manifest)
    labels = derive(history, recipe.labels, in_force.low_level_sha256)
    first = _record(store, 0)
    check_sources(round_.manifest, base=policy_sha256(first), parent=policy_sha256(in_force))
    unknown = unread(labels, first.bank, meaning)
    asked = meant(spelling(history.rulings), first.bank, meaning)
    obeyed = [label for label in labels if label.text not in unknown]
    taught = _taught(store, history, in_force)
    kept, held_out = split(obeyed, recipe.gate.held_out_share, recipe.gate.at_least, taught)
    replayed, aside = keep_aside(len(demonstrations), recipe.gate.retained)
    retained = demonstrations.take(aside)
    policy = open_version(in_force, files)
    before, knew = agreed(policy, held_out, store, asked), known(policy, retained)
    if recipe.train.start == "base":
        policy = open_version(first, files)
    bank, spelt = renew(policy.bank, first.bank, obeyed)
    learned = [*treat(kept)] if treat else kept
    said = gather(balance(learned, recipe.balance), spelt, store) if learned else None

    def told(step: int, steps: int, loss: float) -> bool:
        del loss  # Unused.
        progress(step / steps)
        return True

    settings = fit_settings(recipe.train, round_.seed, len(learned))
    replay = demonstrations.take(replayed)
    report = fit(policy.net, bank, replay, said, settings, told, kept=under_way)
    anchor(policy.net, open_version(first, files).net, recipe.train.own_weights)
    policy = HighLevel(policy.net, bank, policy.version)
    after = agreed(policy, held_out, store, asked)
    figures = Figures(
        labels=len(learned),
        labels_sha256=sha256_labels(labels),
        held_out=len(held_out),
        loss=report.loss if np.isfinite(report.loss) else None,
        finite=all(np.isfinite(array).all() for array in policy.tensors().values()),
        seconds=round(time.monotonic() - began, 3),
        before=_share(before),
        after=_share(after),
        p=round(mcnemar(after, before), 4) if held_out else None,
        p_fall=fall_by_chance(held_out, before, after),
        retained=len(retained),
        retained_before=knew,
        retained_after=known(policy, retained),
        unread=unknown,
        code=code_version(),
    )
    return Candidate(
        tensors=tuple(files.add(name, array) for name, array in policy.tensors().items()),
        bank=bank.phrases,
        settings=policy.settings(),
        figures=figures,
        learned=_corrections(learned),
        held_out=_corrections(held_out),
    )


def _taught(store: Store, history: History, version: PolicyRecord) -> frozenset[str]:
    """The episodes of which a version learned anything that people said."""
    round_ = descent(version, store).round
    learned = frozenset(((round_ and round_.candidate) or {}).get("learned", ()))
    return frozenset(one.episode for one in history.corrections if one.id in learned)


def _share(right: Sequence[bool]) -> float | None:
    return sum(right) / len(right) if right else None


def _corrections(labels: Sequence[Label]) -> tuple[str, ...]:
    return tuple(sorted({label.correction for label in labels}))


def _record(store: Store, number: int) -> PolicyRecord:
    record = store.version(number)
    if record is None:
        raise PolicyError(f"the store has no version number {number}")
    return record


def fit_settings(settings: TrainSettings, seed: int, labels: int) -> FitSettings:
    """What a fit is told of the settings of a round with so many labels."""
    return FitSettings(
        steps=settings.updates(labels),
        batch=settings.batch,
        lr=settings.lr,
        frozen_encoder=settings.frozen_encoder,
        mind_rate=settings.mind_rate,
        retoned=settings.retoned,
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


def reader(folder: Path, any_of_several: bool = False) -> Meaning:
    """What a low level takes phrases for in any scene; it is loaded at the first one.

    any_of_several: "the red one" has another meaning in each scene, and so none in any; then it is
        told as one of them, since it could be obeyed.
    """

    @cache
    def low_level() -> LowLevel:
        return LowLevel.load(folder)

    def meaning(phrase: str) -> str | None:
        _, everything = low_level().anywhere()
        goal = LanguageGoal(text=phrase)
        alike = low_level().options(goal, everything) if any_of_several else ()
        return low_level().meaning(goal, everything) or next(iter(alike), None)

    return meaning


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
            folder = job.demonstrations or bundled("demonstrations")
            check_sources(round_.manifest, demonstrations=load_card(folder).tensors_sha256)
            demonstrations = examples.load(folder)
            files = TensorFiles(job.tensors)
            reads = reader(job.low_level or bundled("low_level"), any_of_several=True)
            candidate = fine_tune(
                round_, store, files, demonstrations, progress, job.under_way, meaning=reads
            )
        except HldError as error:
            return Report(reason=str(error))
    return Report(progress=1.0, candidate=candidate)


if __name__ == "__main__":
    main()
