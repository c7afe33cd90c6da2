"""What a round keeps aside to judge its candidate by: labels of people, and demonstrations."""

import hashlib
from collections import Counter
from collections.abc import Collection, Sequence

import numpy as np
from numpy.typing import NDArray

from services.learner.labels.aggregate import Label
from shared.intervals import flipped

TELLING = 3
"""Held-out episodes that differ, from which on chance is reckoned; a fall in fewer counts as it is:
two of them could show nothing, however far they fall."""
FEW = 3
"""Episodes of which one is held out: of fewer, too little would be left to learn from."""


def keep_aside(count: int, retained: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Rows of so many demonstrations that are replayed, and those kept aside; always the same.

    At least half of them are replayed.
    """
    rows = np.random.default_rng(0).permutation(count)
    aside = min(retained, count // 2)
    return np.sort(rows[aside:]), np.sort(rows[:aside])


def fall_by_chance(
    labels: Sequence[Label], before: Sequence[bool], after: Sequence[bool]
) -> float | None:
    """`Figures.p_fall` of held-out labels. before, after: whether each is agreed with."""
    gaps = Counter[str]()
    for label, knew, knows in zip(labels, before, after, strict=True):
        gaps[label.episode] += knows - knew
    differing = [gap for gap in gaps.values() if gap]
    return flipped(differing) if len(differing) >= TELLING else None


def split(
    labels: Sequence[Label], share: float, at_least: int = 0, learned: Collection[str] = ()
) -> tuple[list[Label], list[Label]]:
    """Labels to train on, and those to hold out: whole episodes, the same by lot in each round.

    at_least: where chance holds out fewer labels, the next episodes by lot are, too, but no more
        than a fifth of all, or one of three or four: an early round is small, and would not be
        judged. A later round may learn from these.
    learned: episodes that the version in force learned from, which come last there: what it was
        taught it knows, and whatever was not would be held to agree less.
    """
    counts = Counter(label.episode for label in labels)
    lots = {episode: _lot(episode) for episode in counts}
    out = {episode for episode, lot in lots.items() if lot < share}
    most = max(len(lots) // 5, int(len(lots) >= FEW)) if share else 0
    for episode in sorted(lots, key=lambda one: (one in learned, lots[one]))[:most]:
        if sum(counts[one] for one in out) >= at_least:
            break
        out.add(episode)
    kept = [label for label in labels if label.episode not in out]
    return kept, [label for label in labels if label.episode in out]


def _lot(episode: str) -> float:
    """A number in [0, 1) that an episode draws once and for all."""
    return int.from_bytes(hashlib.sha256(episode.encode()).digest()[:6]) / 2**48
