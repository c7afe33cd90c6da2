"""Says what the robot shall do while the low level practises: tasks, random chains, mistakes."""

from collections.abc import Callable, Collection
from typing import Protocol

import numpy as np

from shared.workcell import skills
from shared.workcell.objects import BODY_NAMES, KITCHEN, OBJECT_NAMES, TABLE, Stock
from shared.workcell.skills import SKILLS, Skill
from shared.workcell.state import CellState, in_bin, in_tub, stack_on_plate
from shared.workcell.tasks import TASKS
from shared.workcell.tasks.task import Brief, Task

PATIENCE_DECISIONS = 7
WRONG_DECISIONS = 6
"""A wrong stretch is as long as this at most: longer than the history that a high level is shown,
so that it also learns to leave what it said four times over."""
ELSEWHERE = 0.15
"""Chance of a skill of a filling chain to be any."""


class Commander(Protocol):
    """Asked every 20 steps."""

    def command(self, state: CellState) -> str | None:
        """The command from now on; None when there is nothing left to do."""
        ...


class TaskCommander:
    """The oracle of a task, which now and then says something wrong for a while.

    slips: chance that a decision begins a wrong stretch of some decisions.
    """

    def __init__(
        self, brief: Brief, task: Task, rng: np.random.Generator, slips: float, rest: int = 1
    ) -> None:
        self.brief, self._task, self._rng, self._slips = brief, task, rng, slips
        self._wrong, self._wrong_left, self._rest = "", 0, rest
        self.previous: str | None = None
        self.right = ""

    def command(self, state: CellState) -> str | None:
        """The right command mostly; `right` keeps what would have been right."""
        self.right = self._task.next_command(state, self.brief, self.previous)
        if self.right == skills.WAIT:
            self._rest -= 1
            if self._rest < 0:
                return None
        said = self._mistake(state) or self.right
        self.previous = said
        return said

    def _mistake(self, state: CellState) -> str:
        """Something that could be done, but needn't be right; most often nothing."""
        if self._wrong_left == 0 and self._rng.random() < self._slips:
            possible = [skill.text for skill in SKILLS if skills.possible(skill, state)]
            self._wrong = str(self._rng.choice(possible))
            self._wrong_left = int(self._rng.integers(1, 1 + WRONG_DECISIONS))
        if self._wrong_left == 0:
            return ""
        self._wrong_left -= 1
        return self._wrong


class ChainCommander:
    """Random skills one after another: every skill from every state that skills lead to.

    An episode may also fill one place with all that there is, since a put into a full bin is rare
    otherwise, and lists of many things end with one.
    """

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng
        self._skill: Skill | None = None
        self._before: CellState | None = None
        self._left = 0

    def command(self, state: CellState) -> str | None:
        """The skill in hand until it is achieved or patience ends, then another one."""
        if self._skill is None or self._before is None or self._over(self._skill, state):
            self._skill, self._before = self.draw(state), state
            self._left = PATIENCE_DECISIONS if self._rng.random() < 0.9 else 1
        self._left -= 1
        return self._skill.text

    def _over(self, skill: Skill, state: CellState) -> bool:
        assert self._before is not None  # Set together with the skill.
        if self._left <= 0 or (skill.verb == "wait" and self._rng.random() < 0.6):
            return True
        done = skill.verb != "wait" and skills.achieved(skill, self._before, state)
        return done and self._rng.random() < 0.85

    def draw(self, state: CellState) -> Skill:
        """A random skill, mostly one that makes sense in this state."""
        chances = _HOLDING if state.holding else _EMPTY
        possible = [skill for skill in SKILLS if skills.is_there(skill, state)]
        weights = np.array([chances[skill.verb] for skill in possible])
        picks = np.array([skill.verb == "pick" for skill in possible])
        weights[picks] /= max(1, picks.sum())
        row = self._rng.choice(len(possible), p=weights / weights.sum())
        return possible[int(row)]


class FillCommander(ChainCommander):
    """A chain that brings one thing after another to the same place, most of the time."""

    def __init__(self, rng: np.random.Generator, stock: Stock) -> None:
        super().__init__(rng)
        self._place = str(rng.choice([place for place in _FILLED if place in stock]))

    def draw(self, state: CellState) -> Skill:
        """Pick up what isn't there yet, and put it there; now and then anything."""
        there = _FILLED[self._place](state)
        fits = [
            skill
            for skill in SKILLS
            if skills.is_there(skill, state)
            and (skill.verb == self._place if state.holding else _is_left(skill, there))
        ]
        if not fits or self._rng.random() < ELSEWHERE:
            return super().draw(state)
        return fits[int(self._rng.integers(len(fits)))]


_FILLED: dict[str, Callable[[CellState], Collection[int]]] = {
    "plate": stack_on_plate,
    "bin": in_bin,
    "tub": in_tub,
}


def _is_left(skill: Skill, there: Collection[int]) -> bool:
    """Whether it picks up something that isn't there."""
    return skill.object is not None and BODY_NAMES.index(skill.object) not in there


_HOLDING = {"plate": 0.30, "tub": 0.33, "bin": 0.33, "down": 0.26, "wait": 0.03, "pick": 0.10}
_EMPTY = {"plate": 0.01, "tub": 0.01, "bin": 0.01, "down": 0.01, "wait": 0.04, "pick": 0.92}


def draw_commander(
    rng: np.random.Generator, chains: float, mistakes: float, filling: float
) -> tuple[Commander, Stock]:
    """A random chain with chance `chains`, else a random task; and what is on the table.

    filling: share of the chains that fill one place.
    """
    if rng.random() < chains:
        if filling and rng.random() < filling:
            stock = (KITCHEN, TABLE)[int(rng.integers(2))]
            return FillCommander(rng, stock), stock
        return ChainCommander(rng), draw_stock(rng)
    task = list(TASKS.values())[int(rng.integers(len(TASKS)))]
    brief = task.sample(rng)
    return TaskCommander(brief, task, rng, mistakes), KITCHEN


def draw_stock(rng: np.random.Generator) -> Stock:
    """One of the tables, in half of all cases with some of its things missing."""
    whole = (KITCHEN, TABLE)[int(rng.integers(2))]
    if rng.random() < 0.5:
        return whole
    things = [name for name in sorted(whole) if name in OBJECT_NAMES]
    kept = rng.permutation(things)[: int(rng.integers(2, len(things)))]
    return frozenset((*(str(name) for name in kept), *(whole - set(things))))
