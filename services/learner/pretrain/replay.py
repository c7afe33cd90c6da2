"""Chooses the few demonstrations that travel with the project, to be mixed into every round."""

import numpy as np
from numpy.typing import NDArray

from services.learner.pretrain.demonstrate import Demonstrations


def choose(lessons: Demonstrations, count: int, seed: int) -> NDArray[np.int64]:
    """Rows of `count` decisions, in order: rare commands are taken more often than their share.

    The chance of a decision falls with the root of how common its label is.
    """
    labels = np.array(lessons.examples.labels)
    names, kinds, sizes = np.unique(labels, return_inverse=True, return_counts=True)
    del names  # Unused.
    chances = 1.0 / np.sqrt(sizes[kinds])
    count = min(count, len(labels))
    rows = np.random.default_rng(seed).choice(
        len(labels), count, replace=False, p=chances / chances.sum()
    )
    return np.sort(rows)
