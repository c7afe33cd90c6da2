"""How sure a figure is: the interval that goes with each one that is reported, and paired tests.

Rates have Wilson's interval. What is compared on the same seeds is compared pair by pair, by
Newcombe's interval; over several training seeds by a bootstrap with both kinds of chance in it:
which seed was trained, which scene came.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Z_95 = 1.959963984540054
DRAWS = 10_000


class Difference(NamedTuple):
    """How much more the first is than the second, with a 95 % interval."""

    value: float
    low: float
    high: float


def wilson(successes: int, n: int) -> tuple[float, float]:
    """The 95 % interval of a success rate; (0, 1) when nothing was tried.

    Source: Wilson 1927, as in Brown, Cai, DasGupta 2001: it stays sensible near 0 and 1.
    """
    if n == 0:
        return (0.0, 1.0)
    rate = successes / n
    centre = (rate + Z_95**2 / (2 * n)) / (1 + Z_95**2 / n)
    half = Z_95 / (1 + Z_95**2 / n) * math.sqrt(rate * (1 - rate) / n + Z_95**2 / (4 * n**2))
    return (max(0.0, centre - half), min(1.0, centre + half))


def rate(outcomes: Sequence[bool]) -> dict[str, Any]:
    """`success`, `n` and `interval` of outcomes, rounded, as reports carry them."""
    successes, n = sum(outcomes), len(outcomes)
    low, high = wilson(successes, n)
    return {
        "success": round(successes / max(1, n), 4),
        "n": n,
        "interval": [round(low, 4), round(high, 4)],
    }


def mcnemar(first: Sequence[bool], second: Sequence[bool]) -> float:
    """The exact two-sided p-value of paired outcomes; 1 where no pair differs.

    Source: McNemar 1947; exact by the binomial of the pairs that differ.
    Raises:
        ValueError: the two are not of one length.
    """
    only_first = sum(one and not other for one, other in zip(first, second, strict=True))
    only_second = sum(other and not one for one, other in zip(first, second, strict=True))
    n = only_first + only_second
    tail = sum(math.comb(n, k) for k in range(min(only_first, only_second) + 1))
    return float(min(1.0, 2 * tail / 2**n))


def flipped(gaps: Sequence[int]) -> float:
    """The exact one-sided p-value of a sum of gaps: how probable is one as low, were it as likely
    of each gap that it had the other sign? 1 where there is none.

    For pairs that hang together in groups, a gap each. n of them show no less than 2^-n.
    Source: Fisher 1935, The Design of Experiments, §21.
    """
    ways, sizes = np.ones(1), [abs(gap) for gap in gaps if gap]
    for size in sizes:  # Ways to each sum, the lowest first.
        ways = (np.pad(ways, (0, 2 * size)) + np.pad(ways, (2 * size, 0))) / 2
    return float(min(1.0, ways[: sum(gaps) + sum(sizes) + 1].sum()))


def paired_difference(first: Sequence[bool], second: Sequence[bool]) -> Difference:
    """The rate of first less that of second, over pairs; never without width, also near 0 and 1.

    Source: Newcombe 1998 (Statistics in Medicine 17:2635), method 10: Wilson's intervals of both
    rates, put together with their correlation.
    Raises:
        ValueError: the two are not of one length, or empty.
    """
    n = len(_gaps([first], [second])[0])
    mine, its = sum(first), sum(second)
    both = sum(one and other for one, other in zip(first, second, strict=True))
    p1, p2 = mine / n, its / n
    (low1, high1), (low2, high2) = wilson(mine, n), wilson(its, n)
    phi = _correlation(both, mine - both, its - both, n - mine - its + both)
    below = _joined(p1 - low1, high2 - p2, phi)
    above = _joined(high1 - p1, p2 - low2, phi)
    return Difference(p1 - p2, p1 - p2 - below, p1 - p2 + above)


def _correlation(both: int, only_first: int, only_second: int, neither: int) -> float:
    """φ of a table of pairs, less n/2 in its numerator where that is positive, as method 10 has it;
    0 where one side never varies."""
    n = both + only_first + only_second + neither
    mine, its = both + only_first, both + only_second
    margins = mine * (n - mine) * its * (n - its)
    if not margins:
        return 0.0
    cross = both * neither - only_first * only_second
    return (max(cross - n / 2, 0.0) if cross > 0 else cross) / math.sqrt(margins)


def _joined(one: float, other: float, phi: float) -> float:
    return math.sqrt(max(0.0, one**2 - 2 * phi * one * other + other**2))


def seeds_difference(
    first: Sequence[Sequence[float]],
    second: Sequence[Sequence[float]],
    seed: int = 0,
    draws: int = DRAWS,
) -> Difference:
    """The same over training seeds × evaluation seeds: [S][N] outcomes each, paired in both.

    The bootstrap draws training seeds, and evaluation scenes once for all of them, since what is
    hard in a scene is hard for each. Where all pairs differ alike it has nothing to draw from, and
    would claim to know exactly: then the interval is that of one training seed's pairs.
    Source: hierarchical bootstrap, as in Saravanan et al. 2020 (arXiv 2007.07797).
    Raises:
        ValueError: the two are not of one shape, or empty.
    """
    gaps = _gaps(first, second)  # [S, N]
    trainings, scenes = gaps.shape
    if np.ptp(gaps) == 0:
        return paired_difference([bool(won) for won in first[0]], [bool(won) for won in second[0]])
    chance, means = np.random.default_rng(seed), np.empty(draws)
    for draw in range(draws):
        rows = chance.integers(trainings, size=trainings)
        columns = chance.integers(scenes, size=scenes)
        means[draw] = gaps[np.ix_(rows, columns)].mean()
    low, high = np.percentile(means, [2.5, 97.5])
    return Difference(float(gaps.mean()), float(low), float(high))


def _gaps(
    first: Sequence[Sequence[float]], second: Sequence[Sequence[float]]
) -> NDArray[np.float64]:
    try:
        one, other = np.array(first, np.float64), np.array(second, np.float64)
    except ValueError:
        raise ValueError("every training seed needs the same evaluation seeds") from None
    if one.shape != other.shape or one.ndim != 2 or not one.size:
        raise ValueError(f"outcomes come in pairs [S][N], not {one.shape} and {other.shape}")
    return one - other
