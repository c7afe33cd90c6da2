"""A learner that is poisoned on purpose: right words, but each at another decision.

With the gate's defaults, since that is what stands between a mistake and the robots where nobody
set anything.
"""

from collections.abc import Mapping, Sequence
from itertools import cycle, islice

import numpy as np
import pytest
import torch

from services.learner.build import origin
from services.learner.config import Recipe
from services.learner.gate import Candidate, GateSettings, LabelGate, Verdict
from services.learner.gather import open_version
from services.learner.labels.aggregate import Label
from services.learner.store.memory import MemoryStore
from services.learner.store.store import Manifest, PolicyRecord, Round, RoundState
from services.learner.store.tensors import TensorFiles
from services.learner.train import Treatment, fine_tune
from shared.policies.examples import Examples
from shared.policies.fit import fit
from shared.policies.fitter import FitSettings
from shared.policies.high_level import HighLevel
from tests.unit.learner.checkpoints import small_checkpoints
from tests.unit.learner.records import (
    CHEESE,
    HAM,
    LOW,
    TOAST,
    arrays,
    correction,
    decision,
    episode,
    receipt,
)
from tests.unit.learner.test_gate import after_trials

GATE = LabelGate(GateSettings())
RIGHT = {20: HAM, 80: CHEESE, 140: "wait", 200: TOAST}
"""What each shade of grey asks for."""
TAUGHT = (20, 200)
"""The shades that demonstrations show; as of a new site, the base knows only a part."""
OWN = {HAM: "grab the ham", CHEESE: "get the cheese", TOAST: "fetch the toast", "wait": "hold on"}
COMMANDS = dict(zip(RIGHT.values(), RIGHT.values(), strict=True))


def demonstrations() -> Examples:
    shades = [*islice(cycle(TAUGHT), 24)]
    pictures = np.array(shades, np.uint8)[:, None, None, None, None]
    return Examples(
        images=np.broadcast_to(pictures, (24, 2, 64, 64, 3)).copy(),
        prompts=["make a sandwich with cheese"] * 24,
        previous=[()] * 24,
        labels=[RIGHT[shade] for shade in shades],
        weights=np.ones(24, np.float32),
        senses=np.zeros((24, 22), np.float32),
        looks=np.arange(24)[:, None],
    )


@pytest.fixture(scope="module")
def base(tmp_path_factory: pytest.TempPathFactory) -> tuple[PolicyRecord, TensorFiles]:
    """A version that has learned the demonstrations."""
    torch.set_num_threads(1)
    folder = tmp_path_factory.mktemp("base")
    files = TensorFiles(folder / "tensors")
    record = origin(small_checkpoints(folder).high_level, files, LOW, 1)
    policy = open_version(record, files)
    fit(policy.net, policy.bank, demonstrations(), None, FitSettings(steps=40, batch=16, lr=1e-3))
    policy = HighLevel(policy.net, policy.bank, policy.version)
    tensors = tuple(files.add(name, array) for name, array in policy.tensors().items())
    made = record.model_copy(update={"tensors": tensors, "settings": policy.settings()})
    return made, files


class School:
    """In each episode all four shades are seen, and somebody says what each asks for."""

    def __init__(
        self,
        base: tuple[PolicyRecord, TensorFiles],
        episodes: int = 40,
        words: Mapping[str, str] = COMMANDS,
    ) -> None:
        """words: how commands are put."""
        record, self.files = base
        self.store = MemoryStore()
        self._means = {text: command for command, text in words.items()}
        self.store.found(record.model_copy(update={"epoch": self.store.take_over("learner", 1)}))
        for name in (f"e-{number}" for number in range(episodes)):
            for step, (shade, command) in zip(range(0, 160, 40), RIGHT.items(), strict=True):
                seen = decision(name, step, arrays=arrays(shade))
                about = {"episode": name, "decision": seen.id, "hold_steps": 5}
                said = correction(f"{seen.id}-c", words[command], **about)
                self.store.add(seen, 1)
                self.store.add(said, 1)
                self.store.add(receipt(said.id, step, episode=name), 1)
            self.store.add(episode(name, decisions=4, corrections=4), 1)

    def round(self, number: int, treat: Treatment | None = None, steps: int = 60) -> Candidate:
        train = {"steps": steps, "epochs": 0, "batch": 16, "correction_share": 0.8}
        train["mind_rate"] = 1.0  # With so few updates.
        recipe = Recipe.model_validate({"train": train})
        marks = self.store.survey(Manifest()).marks
        manifest = Manifest(marks=marks, settings=recipe.model_dump(mode="json"))
        round_ = Round(
            number=number, epoch=1, parent=number - 1, seed=1, manifest=manifest, begun_ns=1
        )
        self.store.begin(round_)
        made = fine_tune(
            round_,
            self.store,
            self.files,
            demonstrations(),
            _untold,
            treat=treat,
            meaning=self._means.get,
        )
        told = made.model_dump(mode="json")
        ended = round_.model_copy(
            update={"state": RoundState.PASSED, "made": number, "candidate": told}
        )
        self.store.end(ended, self._record(number, made))
        return made

    def _record(self, number: int, made: Candidate) -> PolicyRecord:
        before = self.store.version(number - 1)
        assert before is not None
        new = {"number": number, "tensors": made.tensors, "settings": made.settings}
        return before.model_copy(update=new | {"bank": made.bank})


def shuffled(labels: Sequence[Label]) -> list[Label]:
    """Every word at another decision: at the one before, which is of another shade."""
    texts = [label.text for label in labels]
    moved = [*texts[1:], texts[0]]
    return [label._replace(text=text) for label, text in zip(labels, moved, strict=True)]


@pytest.mark.timeout(600)
def test_shuffled_corrections_do_not_get_past_the_gate_after_an_honest_round(
    base: tuple[PolicyRecord, TensorFiles],
) -> None:
    school = School(base)
    honest = school.round(1)
    assert GATE.judge(honest) == Verdict(True)
    assert honest.figures.held_out >= GateSettings().at_least
    assert honest.figures.before is not None
    assert honest.figures.after is not None
    assert honest.figures.before < 0.8 < honest.figures.after
    _refused_by_labels(school.round(2, shuffled))


@pytest.mark.timeout(600)
@pytest.mark.parametrize("words", [COMMANDS, OWN], ids=["commands", "words of their own"])
def test_shuffled_corrections_do_not_get_past_the_gate_in_the_first_round(
    base: tuple[PolicyRecord, TensorFiles], words: Mapping[str, str]
) -> None:
    poisoned = School(base, words=words).round(1, shuffled)
    assert poisoned.figures.before is not None
    assert poisoned.figures.before > 0.3
    _refused_by_labels(poisoned)
    # Nor where there are trials that neither version succeeds in, as a base at a new site.
    assert not after_trials(poisoned, 0, 0).passed


@pytest.mark.timeout(600)
def test_a_first_round_of_too_few_labels_gets_past_the_gate_neither_poisoned_nor_honest(
    base: tuple[PolicyRecord, TensorFiles],
) -> None:
    for treat in (shuffled, None):
        verdict = GATE.judge(School(base, episodes=4).round(1, treat, steps=2))
        assert not verdict.passed
        assert verdict.unjudged == "held out 4 labels, needs 20: not judged"


def _refused_by_labels(made: Candidate) -> None:
    verdict = GATE.judge(made)
    assert (verdict.passed, verdict.unjudged) == (False, "")
    assert "held-out labels" in verdict.reason


def _untold(share: float) -> None:
    del share  # Unused.
