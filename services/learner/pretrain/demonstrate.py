"""Demonstrations of the tasks in the lab, cut into decisions and labelled in words.

The right command is known at each decision; now and then something else is done instead, hands
shake and slip, so that there are also the states from which one has to recover.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from safetensors.numpy import load_file, save_file

from services.learner.pretrain.commander import TaskCommander
from services.learner.pretrain.practice import DECISION_STEPS, Noise
from shared.evaluation.hand import Hand
from shared.messages.observation import Observation
from shared.policies import examples
from shared.policies.examples import Examples
from shared.policies.high_level import HighLevel
from shared.policies.low_level import LowLevel
from shared.workcell import expert, skills
from shared.workcell.env import WorkcellEnv, proprioception
from shared.workcell.objects import BODY_NAMES, COUNT
from shared.workcell.site import Site
from shared.workcell.state import CellState, in_bin, in_tub, near_plate
from shared.workcell.tasks import Draw
from shared.workcell.tasks.manners import Manner

HISTORY = 4
LOOKS = 4
STATUSES = ON_TABLE, IN_HAND, ON_PLATE, IN_BIN, IN_TUB, ABSENT = range(6)
USUAL_LENGTH = 0.6
"""Share of episodes of a task's usual length."""
LENGTHS = (4, 6, 8, 10, 12)
"""Skills of the other episodes."""
CONSTRAINTS = 0.4
MANNERS: tuple[Manner, ...] = ("plain", "plain", "polite", "chatty")
DRIVEN = 0.8
"""Share of decisions that are a driver's; the others help it out where it is stuck."""
NOTHING = np.zeros((len(BODY_NAMES), 9), np.float32)
"""The objects of an observation, which no high level looks at."""
EARLY = 0.15
"""Share of decisions that come before it is time, as they do where a command was achieved."""


@dataclass(frozen=True)
class Lesson:
    """What one process shall demonstrate.

    seeds: one episode each. low_level: folder of the checkpoint that moves the arms; None: the
    expert does. mistakes: chance that a decision begins a wrong stretch.
    driver: folder of the high level that says what is done in most decisions; None: the task's
    oracle does, mistakes aside. The labels are the oracle's always.
    slips: chance that a holding hand opens in a control step.
    """

    seeds: tuple[int, ...]
    low_level: Path | None = None
    mistakes: float = 0.05
    driver: Path | None = None
    slips: float = 0.002


@dataclass(frozen=True, eq=False)
class Demonstrations:
    """Decisions, and for each the true state of the eighteen bodies, which only training may see.

    status: [M, 18] int64, `ON_TABLE` and so on. positions: [M, 18, 3] float32, in m, zero for
    what is absent. episodes: [M] int64, equal for the decisions of one episode.
    """

    examples: Examples
    status: NDArray[np.int64]
    positions: NDArray[np.float32]
    episodes: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.examples)

    def save(self, file: Path) -> None:
        """Write as safetensors."""
        tensors = examples.as_tensors(self.examples)
        tensors |= {"status": self.status, "positions": self.positions, "episodes": self.episodes}
        save_file(tensors, file)

    @classmethod
    def load(cls, file: Path) -> "Demonstrations":
        """Read back."""
        arrays = load_file(file)
        truth = arrays["status"], arrays["positions"], arrays["episodes"]
        return cls(examples.from_tensors(arrays), *truth)

    def take(self, rows: NDArray[np.int64]) -> "Demonstrations":
        """Some decisions, in the order of `rows`."""
        kept = self.examples.take(rows)
        return Demonstrations(kept, self.status[rows], self.positions[rows], self.episodes[rows])


class Record:
    """Decisions as they are made."""

    def __init__(self) -> None:
        self.images: list[NDArray[np.uint8]] = []
        self.prompts: list[str] = []
        self.previous: list[tuple[str, ...]] = []
        self.labels: list[str] = []
        self.senses: list[NDArray[np.float32]] = []
        self.looks: list[list[int]] = []
        self.status: list[list[int]] = []
        self.positions: list[NDArray[np.float64]] = []
        self.episodes: list[int] = []
        self._first = 0

    def begin(self) -> None:
        """What comes now has no past."""
        self._first = len(self.images)

    def add(self, env: WorkcellEnv, seed: int, previous: Sequence[str], label: str) -> None:
        """One decision; those since `begin` are its past."""
        now = len(self.images)
        looked = range(now - LOOKS + 1, now + 1)
        self.looks.append([row if row >= self._first else -1 for row in looked])
        self.images.append(env.images())
        self.prompts.append(env.brief.prompt)
        self.previous.append(tuple(previous[-HISTORY:]))
        self.labels.append(label)
        self.senses.append(proprioception(env.state))
        self.status.append(_status(env.state))
        self.positions.append(env.state.positions * env.state.present[:, None])
        self.episodes.append(seed)

    def answer(self, driver: HighLevel) -> str:
        """What a high level would say at the last decision."""
        arrays = {"images": self.images[-1], "proprioception": self.senses[-1], "objects": NOTHING}
        seen = Observation(
            step=0, prompt=self.prompts[-1], previous=self.previous[-1], arrays=arrays
        )
        past = [self.images[row] for row in self.looks[-1][:-1] if row >= 0]
        return driver.propose(seen, past)[0].goal.text

    def done(self) -> Demonstrations:
        made = Examples(
            np.stack(self.images),
            self.prompts,
            self.previous,
            self.labels,
            np.ones(len(self.labels), np.float32),
            np.stack(self.senses),
            np.array(self.looks, np.int64),
        )
        positions = np.stack(self.positions).astype(np.float32)
        return Demonstrations(made, np.array(self.status), positions, np.array(self.episodes))


def demonstrate(lesson: Lesson) -> Demonstrations:
    """Episodes in the lab, each until its task is done or time is over."""
    lab = Site(name="lab", slip_rate=lesson.slips)
    env = WorkcellEnv(lab)
    low_level = LowLevel.load(lesson.low_level) if lesson.low_level else None
    driver = HighLevel.load(lesson.driver) if lesson.driver else None
    record = Record()
    for seed in lesson.seeds:
        episode(env, seed, lesson, record, low_level, driver)
    env.close()
    return record.done()


def draw(rng: np.random.Generator) -> Draw:
    """How the wish of an episode is drawn: of any length, in any manner, some with constraints."""
    usual = rng.random() < USUAL_LENGTH
    length = None if usual else int(rng.choice(LENGTHS))
    return Draw(length, MANNERS[int(rng.integers(len(MANNERS)))], CONSTRAINTS)


def episode(
    env: WorkcellEnv,
    seed: int,
    lesson: Lesson,
    record: Record,
    low_level: LowLevel | None = None,
    driver: HighLevel | None = None,
    expected: Callable[[str, NDArray[np.float64]], None] | None = None,
    drawn: bool = True,
) -> None:
    """One episode into the record.

    drawn: its wish as demonstrations in the lab have them; else as the site's people wish.
    expected: told before each control step of the command in force and of the action [14] that the
    expert wants for it, before any noise; never where a low level moves the arms.
    """
    rng = np.random.default_rng([seed, 1])
    if drawn:
        env.draw = draw(rng)
    env.reset(seed=seed)
    commander = TaskCommander(env.brief, env.task, rng, lesson.mistakes)
    hand, noise, said = Hand(low_level) if low_level else None, Noise(rng), [""][:0]
    over, due = False, 0
    record.begin()
    while not over:
        if env.elapsed_steps == due:
            early = rng.random() < EARLY
            due += int(rng.integers(6, DECISION_STEPS)) if early else DECISION_STEPS
            command = commander.command(env.state) or skills.WAIT
            record.add(env, seed, said, commander.right)
            if driver and rng.random() < DRIVEN:
                command = commander.previous = record.answer(driver)
            said.append(command)
            if hand:
                hand.obey(command)
        if hand:
            action = hand.move(env)
        else:
            wanted = expert.act(env.state, skills.parse(said[-1]))
            if expected:
                expected(said[-1], wanted)
            action = wanted + noise.draw()
        _, _, terminated, truncated, _ = env.step(action)
        over = terminated or truncated


def _status(state: CellState) -> list[int]:
    """Where each of the eighteen bodies is; fixtures stand on the table."""
    plated, packed, cleared = near_plate(state), in_bin(state), in_tub(state)
    status = [
        IN_HAND
        if item in state.holding
        else ON_PLATE
        if item in plated
        else IN_BIN
        if item in packed
        else IN_TUB
        if item in cleared
        else ON_TABLE
        for item in range(COUNT)
    ]
    status += [ON_TABLE] * (len(BODY_NAMES) - COUNT)
    there = zip(status, state.present, strict=True)
    return [where if present else ABSENT for where, present in there]


def join(parts: Sequence[Demonstrations]) -> Demonstrations:
    """All parts one after another."""
    return Demonstrations(
        examples.join([part.examples for part in parts]),
        np.concatenate([part.status for part in parts]),
        np.concatenate([part.positions for part in parts]),
        np.concatenate([part.episodes for part in parts]),
    )
