"""Practice of the low level: the expert shows, later the learner drives and the expert takes over.

What is kept are runs, unbroken stretches in which the expert drove with one command; each step
of a run is a state with the expert's answer, and the answers that follow are its action chunk.
"""

from collections.abc import Iterable
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from safetensors.numpy import load_file, save_file

from services.learner.pretrain.commander import draw_commander
from shared.messages.goal import LanguageGoal
from shared.policies.low_level import LowLevel
from shared.workcell import expert, skills
from shared.workcell.cell import Cell
from shared.workcell.env import objects, proprioception
from shared.workcell.people import shift_plate
from shared.workcell.site import Site
from shared.workcell.skills import COMMANDS

DECISION_STEPS = 20
EXECUTE_STEPS = 5
EPISODE_STEPS = 900
NOISE_RAD = 0.02
NOISE_MEMORY = 0.8
NOISE_LEVELS = (0.0, 0.5, 1.0, 1.5)
CHAINS = 0.7
"""Share of episodes that are random chains of skills, not tasks."""
PLATE_MOVES = 0.4
"""Share of episodes in which the plate stands elsewhere."""
PRACTICE_SITE = Site(name="practice", slip_rate=0.003)
"""The lab with hands that slip, so that recovery is practised."""


@dataclass(frozen=True, eq=False)
class Steps:
    """N steps that the expert drove, in order.

    proprioception [N, 22], objects [N, 18, 9]: float32, as in `Observation`.
    actions: [N, 14] float32, what the expert wanted, before any noise.
    commands: [N] int16, row of `COMMANDS`. done: [N] bool, whether the command is achieved.
    runs: [N] int32, equal within an unbroken stretch.
    """

    proprioception: NDArray[np.float32]
    objects: NDArray[np.float32]
    actions: NDArray[np.float32]
    commands: NDArray[np.int16]
    done: NDArray[np.bool_]
    runs: NDArray[np.int32]

    def __len__(self) -> int:
        return len(self.runs)

    def save(self, file: Path) -> None:
        """Write as safetensors."""
        save_file({field.name: getattr(self, field.name) for field in fields(self)}, file)

    @classmethod
    def load(cls, file: Path) -> "Steps":
        """Read back."""
        return cls(**load_file(file))


def join(parts: Iterable[Steps]) -> Steps:
    """All parts one after another, their runs kept apart."""
    parts, first, shifted = list(parts), 0, []
    for part in parts:
        shifted.append(part.runs + first)
        first += int(part.runs.max(initial=0)) + 1
    arrays = {
        name: np.concatenate([getattr(part, name) for part in parts])
        for name in ("proprioception", "objects", "actions", "commands", "done")
    }
    return Steps(**arrays, runs=np.concatenate(shifted).astype(np.int32))


def practise(seed: int, steps: int, folder: Path | None, filling: float = 0.0) -> Steps:
    """`steps` taught steps in episodes of their own; the last one is broken off.

    folder: checkpoint of the low level that drives between the expert's turns; None: the expert
    drives always. filling: share of the chains that fill one place.
    """
    session = _Session(seed, LowLevel.load(folder) if folder else None, filling)
    while len(session.runs) < steps:
        session.episode(steps)
    return session.result()


class _Session:
    """The work of one process."""

    def __init__(self, seed: int, learner: LowLevel | None, filling: float) -> None:
        self._rng, self._filling = np.random.default_rng(seed), filling
        self._cell = Cell(PRACTICE_SITE)
        self._learner = learner
        self._seen: list[NDArray[np.float32]] = []
        self._things: list[NDArray[np.float32]] = []
        self._wanted: list[NDArray[np.float64]] = []
        self._commands: list[int] = []
        self._done: list[bool] = []
        self.runs: list[int] = []
        self._run = 0

    def episode(self, most: int) -> None:
        """One scene, worked on until its task is done, time is over or `most` steps are kept."""
        rng = self._rng
        commander, stock = draw_commander(rng, chains=CHAINS, mistakes=0.05, filling=self._filling)
        self._cell.reset(rng, stock)
        if rng.random() < PLATE_MOVES:
            shift_plate(self._cell, self._cell.state(), rng)
        noise = Noise(rng)
        said, expert_left, learner_left = "", 0, 0
        chunk: list[NDArray[np.float32]] = []
        for step in range(EPISODE_STEPS):
            if len(self.runs) == most:
                break
            state = self._cell.state()
            if step % DECISION_STEPS == 0:
                command = commander.command(state)
                if command is None:
                    break
                if command != said:
                    said, skill, chunk = command, skills.parse(command), []
                    before = state
                    self._run += 1
            if expert_left == 0 and learner_left == 0:
                self._run += 1
                expert_left, learner_left = self._turns()
            if learner_left and self._learner:
                if not chunk:
                    acts = self._learner.act(
                        proprioception(state), objects(state), LanguageGoal(text=said)
                    )
                    chunk = list(acts[:EXECUTE_STEPS])
                self._cell.step(chunk.pop(0))
                learner_left -= 1
                continue
            chunk, expert_left = [], max(0, expert_left - 1)
            wanted = expert.act(state, skill)
            done = skills.achieved(skill, before, state)
            self._keep(proprioception(state), objects(state), wanted, said, done)
            self._cell.step(wanted + noise.draw())

    def _turns(self) -> tuple[int, int]:
        """How long the expert and then the learner drive."""
        if self._learner is None:
            return EPISODE_STEPS, 0
        # The learner's turn comes first, so that the expert's begins in a state of the learner's.
        return int(self._rng.integers(11, 36)), int(self._rng.integers(1, 50))

    def _keep(
        self,
        seen: NDArray[np.float32],
        things: NDArray[np.float32],
        wanted: NDArray[np.float64],
        said: str,
        done: bool,
    ) -> None:
        self._seen.append(seen)
        self._things.append(things)
        self._wanted.append(wanted)
        self._commands.append(COMMANDS.index(said))
        self._done.append(done)
        self.runs.append(self._run)

    def result(self) -> Steps:
        return Steps(
            np.stack(self._seen),
            np.stack(self._things),
            np.stack(self._wanted).astype(np.float32),
            np.array(self._commands, np.int16),
            np.array(self._done, np.bool_),
            np.array(self.runs, np.int32),
        )


class Noise:
    """Shaky arms: noise on the joint targets that lasts a few steps, redrawn in size now and then.

    Source: noise injection of Laskey et al. 2017 (DART, arXiv 1703.09327), with fixed sizes.
    """

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng, self._value = rng, np.zeros(14)
        self._size = 0.0

    def draw(self) -> NDArray[np.float64]:
        """The next disturbance, [14] rad; the grippers have none."""
        if self._rng.random() < 0.02 or not self._value.any():
            self._size = NOISE_RAD * float(self._rng.choice(NOISE_LEVELS))
        fresh = self._rng.normal(0.0, 1.0, 14) * (1 - NOISE_MEMORY**2) ** 0.5
        self._value = NOISE_MEMORY * self._value + fresh
        self._value[[6, 13]] = 0.0
        return self._value * self._size
