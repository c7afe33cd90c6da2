"""What a task is: it draws and understands prompts, judges states, and knows what is to do next."""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from shared.workcell import skills
from shared.workcell.objects import KITCHEN, Stock
from shared.workcell.state import CellState, cover_of
from shared.workcell.tasks.manners import Manner
from shared.workcell.tasks.wishes import EVERYTHING, Wish

CARRY_M = 0.115
"""The lift is over, and a put may be said, when the held object is higher than this."""
CARRY_SOON_M = 0.095
"""From here on a put is no mistake any more."""
STEPS_PER_SKILL = 75
SPARE_STEPS = 300
LEAST_STEPS = 900


@dataclass(frozen=True)
class Brief:
    """One wish: the task, the sentence that asks for it, and the objects it is about.

    target: names; empty until `settle` where they depend on how things lie at the start.
    ordered: whether the order of the target counts. stock: what is in the cell.
    wish: what the sentence says.
    """

    task: str
    prompt: str
    target: tuple[str, ...]
    wish: Wish = EVERYTHING
    ordered: bool = True
    stock: Stock = KITCHEN

    @property
    def skills(self) -> int:
        """Skills that it takes without a mistake: each thing is picked up and put somewhere."""
        return 2 * len(self.target)

    @property
    def steps(self) -> int:
        """Control steps after which an attempt is a failure."""
        return max(LEAST_STEPS, SPARE_STEPS + STEPS_PER_SKILL * self.skills)

    def settle(self, state: CellState) -> "Brief":
        """The same with the target that follows from how things lie at the start."""
        if not self.wish.sides:
            return self
        return replace(self, target=self.wish.things(self.stock, state))

    def to_json(self) -> dict[str, Any]:
        """What an oracle needs besides the prompt."""
        return {"target": list(self.target), "ordered": self.ordered}


@dataclass(frozen=True)
class Draw:
    """How wishes are drawn.

    skills: how many the episode shall take; None: the task's usual number. manner: how the words
    are put. constraints: share of prompts that say what fits, not what is wanted.
    """

    skills: int | None = None
    manner: Manner = "plain"
    constraints: float = 0.0


USUAL = Draw()


class Task(Protocol):
    """One kind of wish. Every method is a pure function; `sample` alone consumes its rng."""

    @property
    def name(self) -> str:
        """The task's name in the registry."""

    @property
    def lengths(self) -> range:
        """How many skills an episode can be asked to take."""

    def home(self, item: int) -> int:
        """The row of the body that an object goes to if it is wished: plate, bin or tub."""

    def sample(self, rng: np.random.Generator, draw: Draw = USUAL) -> Brief:
        """Draw a wish; `Brief.settle` completes it. Raises: InvalidLength, naming the lengths."""

    def understand(self, prompt: str) -> Brief:
        """The wish that a sentence expresses. Raises: UnknownPrompt, saying a valid form."""

    def success(self, state: CellState, brief: Brief) -> bool:
        """Whether the wish is fulfilled."""

    def progress(self, state: CellState, brief: Brief) -> float:
        """How much of the wish is fulfilled, in [0, 1]."""

    def next_command(self, state: CellState, brief: Brief, previous: str | None) -> str:
        """The right command now. `previous`: the command in force, which tells lift from lower."""

    def acceptable_commands(
        self, state: CellState, brief: Brief, previous: str | None
    ) -> frozenset[str]:
        """All commands that are right now, `next_command` among them."""


class Commanding(ABC):
    """What tasks share: one account of what is right now answers both questions."""

    def next_command(self, state: CellState, brief: Brief, previous: str | None) -> str:
        """The right command now: the one in force if it is right."""
        picks = self._right(state, brief, previous)
        return previous if previous in picks else picks[0]

    def acceptable_commands(
        self, state: CellState, brief: Brief, previous: str | None
    ) -> frozenset[str]:
        """All commands that are right now."""
        return frozenset(self._right(state, brief, previous))

    @abstractmethod
    def _right(self, state: CellState, brief: Brief, previous: str | None) -> list[str]:
        """All right commands, the best first; at least one."""


def put_commands(state: CellState, item: int, put: str, previous: str | None) -> list[str]:
    """All right commands, the best first, while `item` is held and shall be `put`.

    A held object that is low is being lifted or lowered; only the command in force tells which.
    """
    height, lift = state.points[item][2], skills.pick(item)
    if previous in skills.PUTS or height > CARRY_M:
        return [put]
    return [lift, put] if height > CARRY_SOON_M else [lift]


def uncovered(state: CellState, item: int) -> int:
    """`item`, or the topmost object on it that must be taken away first."""
    cover = cover_of(state, item)
    return item if cover is None else cover
