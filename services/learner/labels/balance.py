"""How often each label is drawn: by decision or by correction, and no phrase more than its share.

Corrections dwell on few phrases, and a long override labels many decisions that look alike.
Between `aggregate` and the training of a round; a pure function of the labels.
"""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Annotated, Literal

from pydantic import Field

from services.learner.labels.aggregate import Label
from shared.config import Settings


class BalanceSettings(Settings):
    """What counts alike.

    by: decision: each by its own weight; correction: all that one correction labels together count
        as much as what any other labels.
    phrase_cap: the largest share of what is drawn that one phrase may have; where there are too
        few phrases for it, all have the same.
    """

    by: Literal["decision", "correction"] = "decision"
    phrase_cap: Annotated[float, Field(gt=0, le=1)] = 1.0


def balance(labels: Sequence[Label], settings: BalanceSettings) -> tuple[Label, ...]:
    """The same labels in the same order; their weights have the same sum as before."""
    if settings.by == "correction":
        labels = _by_correction(labels)
    share = _shares(labels, settings.phrase_cap)
    return tuple(label._replace(weight=label.weight * share[label.text]) for label in labels)


def _by_correction(labels: Sequence[Label]) -> list[Label]:
    """Each correction's labels keep their proportions and sum to the mean of all corrections."""
    sums = defaultdict[str, float](float)
    for label in labels:
        sums[label.correction] += label.weight
    mean = sum(sums.values()) / max(1, len(sums))
    return [label._replace(weight=label.weight * mean / sums[label.correction]) for label in labels]


def _shares(labels: Sequence[Label], cap: float) -> Mapping[str, float]:
    """By phrase the factor with which none has more than `cap` of the sum, which stays."""
    sums = defaultdict[str, float](float)
    for label in labels:
        sums[label.text] += label.weight
    total, factor = sum(sums.values()), dict.fromkeys(sums, 1.0)
    if not total:
        return factor
    cap = max(cap, 1.0 / len(sums))
    capped: set[str] = set()
    while over := {name for name in sums if sums[name] * factor[name] > cap * total * (1 + 1e-9)}:
        capped |= over
        rest = sum(sums[name] for name in sums if name not in capped)
        for name in sums:
            left = (1.0 - cap * len(capped)) * total / rest if rest else 0.0
            factor[name] = cap * total / sums[name] if name in capped else left
    return factor
