"""Chooses the few demonstrations that travel with the project, to be mixed into every round."""

import numpy as np
from numpy.typing import NDArray

from services.learner.pretrain.demonstrate import Demonstrations


def choose(lessons: Demonstrations, count: int, seed: int) -> NDArray[np.int64]:
    """Rows of at most `count` decisions, in order: whole episodes, so that earlier looks are there.

    The chance of an episode grows with how rare its commands are: with the mean over its
    decisions of one over the root of how common each label is. At least one episode is chosen.
    """
    labels = np.array(lessons.examples.labels)
    _, kinds, sizes = np.unique(labels, return_inverse=True, return_counts=True)
    _, which = np.unique(lessons.episodes, return_inverse=True)
    lengths = np.bincount(which)
    chances = np.bincount(which, 1.0 / np.sqrt(sizes[kinds])) / lengths
    order = np.random.default_rng(seed).choice(
        len(lengths), len(lengths), replace=False, p=chances / chances.sum()
    )
    fitting = order[np.cumsum(lengths[order]) <= count]
    kept = fitting if len(fitting) else order[:1]
    rows: NDArray[np.int64] = np.flatnonzero(np.isin(which, kept))
    return rows
