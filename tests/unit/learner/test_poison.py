"""A learner that is poisoned on purpose: right words, but each at another decision."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
import torch

from services.learner.build import origin
from services.learner.config import Recipe
from services.learner.gate import Candidate, GateSettings, LabelGate
from services.learner.labels.aggregate import Label
from services.learner.store.memory import MemoryStore
from services.learner.store.store import Manifest, PolicyRecord, Round, RoundState
from services.learner.store.tensors import TensorFiles
from services.learner.train import Treatment, fine_tune
from shared.policies import examples
from tests.unit.learner.checkpoints import Checkpoints, small_checkpoints
from tests.unit.learner.records import (
    HAM,
    LOW,
    TOAST,
    arrays,
    correction,
    decision,
    episode,
    receipt,
)

EPISODES = 40
GATE = GateSettings(held_out_share=0.3, at_least=5, max_fall=0.05, max_forgotten=1.0)


@pytest.fixture(scope="module")
def checkpoints(tmp_path_factory: pytest.TempPathFactory) -> Checkpoints:
    torch.set_num_threads(1)
    return small_checkpoints(tmp_path_factory.mktemp("checkpoints"))


class School:
    """Dark pictures ask for ham, bright ones for toast; somebody says so in each episode."""

    def __init__(self, folder: Path, checkpoints: Checkpoints) -> None:
        self.store, self.files = MemoryStore(), TensorFiles(folder / "tensors")
        self.demonstrations = examples.load(checkpoints.demonstrations)
        epoch = self.store.take_over("learner", 1)
        made = origin(checkpoints.high_level, self.files, LOW, 1)
        self.store.found(made.model_copy(update={"epoch": epoch}))
        for number in range(EPISODES):
            name, bright = f"e-{number}", number % 2
            seen = decision(name, 0, arrays=arrays(200 if bright else 20))
            said = correction(
                f"{name}-c", TOAST if bright else HAM, episode=name, decision=seen.id, hold_steps=5
            )
            self.store.add(seen, 1)
            self.store.add(said, 1)
            self.store.add(receipt(said.id, 0, episode=name), 1)
            self.store.add(episode(name, decisions=1, corrections=1), 1)

    def round(self, number: int, treat: Treatment | None = None) -> Candidate:
        recipe = Recipe.model_validate(
            {
                "train": {"steps": 60, "batch": 16, "correction_share": 0.9},
                "gate": GATE.model_dump(),
            }
        )
        marks = self.store.survey(Manifest()).marks
        manifest = Manifest(marks=marks, settings=recipe.model_dump(mode="json"))
        round_ = Round(
            number=number, epoch=1, parent=number - 1, seed=1, manifest=manifest, begun_ns=1
        )
        self.store.begin(round_)
        made = fine_tune(round_, self.store, self.files, self.demonstrations, _untold, treat=treat)
        ended = round_.model_copy(update={"state": RoundState.PASSED, "made": number})
        self.store.end(ended, self._record(number, made))
        return made

    def _record(self, number: int, made: Candidate) -> PolicyRecord:
        before = self.store.version(number - 1)
        assert before is not None
        return before.model_copy(
            update={"number": number, "tensors": made.tensors, "settings": made.settings}
        )


def shuffled(labels: Sequence[Label]) -> list[Label]:
    """Every word at another decision; here each at one of the other shade."""
    order = np.random.default_rng(0).permutation(len(labels))
    return [label._replace(text=labels[row].text) for label, row in zip(labels, order, strict=True)]


@pytest.mark.timeout(180)
def test_shuffled_corrections_do_not_get_past_the_gate(
    tmp_path: Path, checkpoints: Checkpoints
) -> None:
    school, gate = School(tmp_path, checkpoints), LabelGate(GATE)
    honest = school.round(1)
    assert gate.judge(honest).passed
    assert honest.figures.after is not None
    assert honest.figures.after > 0.9
    poisoned = school.round(2, shuffled)
    verdict = gate.judge(poisoned)
    assert not verdict.passed
    assert "held-out labels" in verdict.reason


def _untold(share: float) -> None:
    del share  # Unused.
