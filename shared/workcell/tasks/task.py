"""What a task is: it draws and understands prompts, judges states, and knows what is to do next."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from shared.workcell import skills
from shared.workcell.errors import InvalidLength
from shared.workcell.objects import OBJECT_NAMES
from shared.workcell.state import CellState, cover_of

CARRY_M = 0.115
"""The lift is over, and a put may be said, when the held object is higher than this."""
CARRY_SOON_M = 0.095
"""From here on a put is no mistake any more."""


@dataclass(frozen=True)
class Brief:
    """One wish: the task, the sentence that asks for it, and the objects it is about, in order."""

    task: str
    prompt: str
    target: tuple[str, ...]


@dataclass(frozen=True)
class Draw:
    """How wishes are drawn.

    skills: how many the episode shall take; None: the task's usual number.
    """

    skills: int | None = None


USUAL = Draw()


class Task(Protocol):
    """One kind of wish. Every method is a pure function; `sample` alone consumes its rng."""

    @property
    def name(self) -> str:
        """The task's name in the registry."""

    @property
    def lengths(self) -> range:
        """How many skills an episode can be asked to take."""

    def sample(self, rng: np.random.Generator, draw: Draw = USUAL) -> Brief:
        """Draw a wish. Raises: InvalidLength, naming the lengths."""

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


def put_commands(
    state: CellState, item: int, put: str, previous: str | None
) -> tuple[str, frozenset[str]]:
    """The right command, and all right ones, while `item` is held and shall be `put`.

    A held object that is low is being lifted or lowered; only the command in force tells which.
    """
    height, lift = state.points[item][2], skills.pick(item)
    if previous in skills.PUTS or height > CARRY_M:
        return put, frozenset({put})
    return lift, frozenset({lift, put} if height > CARRY_SOON_M else {lift})


def check(draw: Draw, name: str, lengths: range) -> None:
    """Refuse a number of skills that a task can't have. Raises: InvalidLength, naming them."""
    if draw.skills is not None and draw.skills not in lengths:
        raise InvalidLength(
            f"a {name} takes {lengths[0]} to {lengths[-1]} skills, an even number; "
            f"got {draw.skills}"
        )


def uncovered(state: CellState, item: int) -> int:
    """`item`, or the topmost object on it that must be taken away first."""
    cover = cover_of(state, item)
    return item if cover is None else cover


def objects_in(text: str) -> tuple[str, ...]:
    """The objects that a sentence names, in its order."""
    pattern = r"\b(" + "|".join(OBJECT_NAMES) + r")s?\b"
    return tuple(re.findall(pattern, text.lower()))


def listing(names: Sequence[str]) -> str:
    """The names as people list them: a, b and c."""
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
