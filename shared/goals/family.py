"""What every family of goals can do, so that a policy need not know which one it serves."""

from collections.abc import Callable
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from shared.errors import PolicyError, nearest
from shared.messages.goal import Goal

Floats = NDArray[np.float32]


class GoalFamily(Protocol):
    """One kind of goal: how it becomes a vector, and how it reads.

    name: as `family` of the goal's message says it. width: D, the length of a goal's vector.
    """

    @property
    def name(self) -> str: ...

    @property
    def width(self) -> int: ...

    def embed(self, goals: tuple[Goal, ...]) -> Floats:
        """The goals as vectors of length 1, [N, D] float32."""
        ...

    def describe(self, goal: Goal) -> str:
        """The goal in words, for people and logs."""
        ...


def _language() -> GoalFamily:
    from shared.goals.language.encoder import LanguageFamily

    return LanguageFamily()


_FAMILIES: dict[str, Callable[[], GoalFamily]] = {"language": _language}


def open_family(name: str) -> GoalFamily:
    """The family called `name`.

    Raises:
        PolicyError: there is none; the message names those there are.
    """
    if name not in _FAMILIES:
        raise PolicyError(f"no goal family {name!r}{nearest(name, _FAMILIES)}")
    return _FAMILIES[name]()
