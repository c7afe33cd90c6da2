"""What the high level saw before: the pictures of the last decisions of an episode."""

from collections import deque

import numpy as np
from numpy.typing import NDArray


class Looks:
    """The earlier observations that the high level is shown besides the present one.

    They are spaced by decisions, so that whoever keeps the decisions has the pictures, too.
    """

    def __init__(self, looks: int, every: int) -> None:
        """looks: with the present one. every: decisions from one to the next."""
        self._ages = range((looks - 1) * every, 0, -every)
        self._pictures: deque[NDArray[np.uint8]] = deque(maxlen=(looks - 1) * every)
        self._taken = 0

    def add(self, pictures: NDArray[np.uint8]) -> None:
        """The next decision was taken from these, [V, 64, 64, 3]."""
        self._pictures.append(pictures)
        self._taken += 1

    def past(self) -> dict[int, NDArray[np.uint8]]:
        """What the coming decision is shown of the past: index of a decision to its pictures.

        Oldest first; fewer at the beginning of an episode.
        """
        there = (age for age in self._ages if age <= len(self._pictures))
        return {self._taken - age: self._pictures[-age] for age in there}
