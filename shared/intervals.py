"""How sure a success rate is: the interval that goes with every figure that is reported."""

import math

Z_95 = 1.959963984540054


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
