"""How things lie in a scene: which is furthest to a side, and what lies on what."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from shared.goals.family import Floats

APART_M = 0.02
"""By so much further to a side lies what is meant by that side."""
PLATE_M, BOX_M = 0.07, 0.10
"""So near to the middle of the plate, or of bin or tub along each wall, a thing lies there."""
FIRST = 15
"""Row of the first fixture: the plate, before bin and tub."""
ON_TOP_M = 0.045
"""Seen from above what lies on a thing is no further from its middle."""
TOUCHING = 0.9
"""Share of both half heights by which what lies on a thing is higher: beside it nothing is."""


def furthest(rows: Sequence[int], side: str, objects: Floats, apart_m: float = 0.0) -> int | None:
    """Which of several things lies furthest to a side, "left" or "right"; None where none does.

    objects: [18, 9], of a scene. apart_m: how much further than the next.
    """
    sign = -1.0 if side == "left" else 1.0  # Left is where x is small.
    reach = [sign * float(objects[row, 0]) for row in rows]
    order = np.argsort(reach)[::-1]
    if len(rows) < 2:
        return rows[0] if rows else None
    return rows[order[0]] if reach[order[0]] - reach[order[1]] > apart_m else None


def place_of(objects: Floats) -> NDArray[np.int64]:
    """[15] On or in which fixture each thing lies, its row of `objects` [18, 9]; -1 for none."""
    things, fixtures = objects[:FIRST, :2], objects[FIRST:, :2]
    there = np.abs(objects).max(-1) > 0
    off = things[:, None] - fixtures[None]  # [15, 3, 2]
    reach = np.abs(off).max(-1) < BOX_M
    reach[:, 0] = np.hypot(off[:, 0, 0], off[:, 0, 1]) < PLATE_M
    reach &= there[:FIRST, None] & there[None, FIRST:]
    found: NDArray[np.int64] = np.where(reach.any(1), FIRST + reach.argmax(1), -1)
    return found


def cover_of(
    row: int, objects: Floats, held: NDArray[np.bool_], half_heights: Floats
) -> int | None:
    """The topmost thing that lies on another, None where that is free.

    held: [15] bool, in the hands. half_heights: [15], of things that lie flat, in m.
    """
    points = objects[: len(held), :3].astype(np.float64)
    away = np.hypot(*(points - points[row])[:, :2].T)
    higher = points[:, 2] - points[row, 2] > TOUCHING * (half_heights + half_heights[row])
    present = np.abs(objects[: len(held)]).max(-1) > 0
    on_top = np.flatnonzero(present & ~held & (away < ON_TOP_M) & higher)
    return int(max(on_top, key=lambda other: points[other, 2])) if len(on_top) else None
