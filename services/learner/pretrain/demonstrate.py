"""Demonstrations of the tasks in the lab, cut into decisions and labelled in words.

The right command is known at each decision; now and then something else is done instead, hands
shake and slip, so that there are also the states from which one has to recover.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from safetensors.numpy import load_file, save_file

from services.learner.pretrain.commander import TaskCommander
from services.learner.pretrain.practice import DECISION_STEPS, EPISODE_STEPS, Noise
from shared.evaluation.hand import Hand
from shared.policies import examples
from shared.policies.checkpoint import Tensors
from shared.policies.examples import Examples, as_bytes, as_texts
from shared.policies.low_level import LowLevel
from shared.workcell import expert, skills
from shared.workcell.env import WorkcellEnv
from shared.workcell.objects import KINDS
from shared.workcell.site import Site
from shared.workcell.state import CellState, in_bin, near_plate

HISTORY = 4
TASKS = ("sandwich", "pack")
"""What the high level is taught: it sees the food; its network knows no dishes yet."""
SEEN = len(KINDS["food"])
ON_TABLE, IN_HAND, ON_PLATE, IN_BIN = range(4)


@dataclass(frozen=True)
class Lesson:
    """What one process shall demonstrate.

    seeds: one episode each. low_level: folder of the checkpoint that moves the arms; None: the
    expert does. mistakes: chance that a decision begins a wrong stretch. slips: chance that a
    holding hand opens in a control step.
    """

    seeds: tuple[int, ...]
    low_level: Path | None = None
    mistakes: float = 0.05
    slips: float = 0.002


@dataclass(frozen=True, eq=False)
class Demonstrations:
    """Decisions, and for each the true state of the seven objects that only training may see.

    status: [M, 7] int64, `ON_TABLE` and so on. positions: [M, 7, 3] float32, in m.
    """

    examples: Examples
    status: NDArray[np.int64]
    positions: NDArray[np.float32]

    def save(self, file: Path) -> None:
        """Write as safetensors."""
        many = self.examples
        arrays: Tensors = {
            "images": many.images,
            "prompts": as_bytes(many.prompts),
            "previous": as_bytes(["\t".join(texts) for texts in many.previous]),
            "labels": as_bytes(many.labels),
            "weights": many.weights,
            "status": self.status,
            "positions": self.positions,
        }
        save_file(arrays, file)

    @classmethod
    def load(cls, file: Path) -> "Demonstrations":
        """Read back."""
        arrays = load_file(file)
        past = as_texts(arrays["previous"])
        many = Examples(
            arrays["images"],
            as_texts(arrays["prompts"]),
            [tuple(texts.split("\t")) if texts else () for texts in past],
            as_texts(arrays["labels"]),
            arrays["weights"],
        )
        return cls(many, arrays["status"], arrays["positions"])


class _Record:
    """Decisions as they are made."""

    def __init__(self) -> None:
        self.images: list[NDArray[np.uint8]] = []
        self.prompts: list[str] = []
        self.previous: list[tuple[str, ...]] = []
        self.labels: list[str] = []
        self.status: list[list[int]] = []
        self.positions: list[NDArray[np.float64]] = []

    def add(self, env: WorkcellEnv, previous: Sequence[str], label: str) -> None:
        self.images.append(env.images())
        self.prompts.append(env.brief.prompt)
        self.previous.append(tuple(previous[-HISTORY:]))
        self.labels.append(label)
        self.status.append(_status(env.state))
        self.positions.append(env.state.positions[:SEEN])

    def done(self) -> Demonstrations:
        weights = np.ones(len(self.labels), np.float32)
        made = Examples(np.stack(self.images), self.prompts, self.previous, self.labels, weights)
        positions = np.stack(self.positions).astype(np.float32)
        return Demonstrations(made, np.array(self.status, np.int64), positions)


def demonstrate(lesson: Lesson) -> Demonstrations:
    """Episodes in the lab, each until its task is done or time is over."""
    lab = Site(name="lab", slip_rate=lesson.slips)
    env = WorkcellEnv(lab)
    low_level = LowLevel.load(lesson.low_level) if lesson.low_level else None
    record = _Record()
    for seed in lesson.seeds:
        _episode(env, seed, lesson, low_level, record)
    env.close()
    return record.done()


def _episode(
    env: WorkcellEnv, seed: int, lesson: Lesson, low_level: LowLevel | None, record: _Record
) -> None:
    env.reset(seed=seed, options={"task": TASKS[seed % len(TASKS)]})
    rng = np.random.default_rng([seed, 1])
    commander = TaskCommander(env.brief, env.task, rng, lesson.mistakes)
    hand, noise, said = Hand(low_level) if low_level else None, Noise(rng), [""][:0]
    for step in range(EPISODE_STEPS):
        if step % DECISION_STEPS == 0:
            command = commander.command(env.state) or skills.WAIT
            record.add(env, said, commander.right)
            said.append(command)
            if hand:
                hand.obey(command)
        if hand:
            action = hand.move(env)
        else:
            action = expert.act(env.state, skills.parse(said[-1])) + noise.draw()
        if env.step(action)[2]:
            break


def _status(state: CellState) -> list[int]:
    """Where each of the seven objects is."""
    packed, plated = in_bin(state), near_plate(state)
    return [
        IN_HAND
        if item in state.holding
        else ON_PLATE
        if item in plated
        else IN_BIN
        if item in packed
        else ON_TABLE
        for item in range(SEEN)
    ]


def join(parts: Sequence[Demonstrations]) -> Demonstrations:
    """All parts one after another."""
    return Demonstrations(
        examples.join([part.examples for part in parts]),
        np.concatenate([part.status for part in parts]),
        np.concatenate([part.positions for part in parts]),
    )
