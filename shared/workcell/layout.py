"""Where things stand: the fixed furniture of the cell, in metres, and the random start.

World frame: origin at the middle of the table top, x to the right arm, y away from the person,
z up. The tray's rim keeps the objects where an arm can reach them.
"""

from dataclasses import dataclass

import numpy as np

from shared.workcell.objects import BIN as BIN_ROW
from shared.workcell.objects import KITCHEN, OBJECTS, Stock, rows
from shared.workcell.objects import TUB as TUB_ROW


@dataclass(frozen=True)
class Box:
    """An upright rectangle in the plane of the table, [m]."""

    x_m: float
    y_m: float
    half_x_m: float
    half_y_m: float

    def contains(self, x: float, y: float, grow_x_m: float = 0.0, grow_y_m: float = 0.0) -> bool:
        """Whether the point lies inside, the rectangle being grown by so much on each side."""
        inside_x = abs(x - self.x_m) <= self.half_x_m + grow_x_m
        return inside_x and abs(y - self.y_m) <= self.half_y_m + grow_y_m

    def on_edge(self, x: float, y: float, near_x_m: float, near_y_m: float) -> bool:
        """Whether the point lies so near to the edge, on either side."""
        outer = self.contains(x, y, near_x_m, near_y_m)
        return outer and not self.contains(x, y, -near_x_m, -near_y_m)


BASE_X_M = 0.42
"""The arms' bases stand at x = -0.42 (left) and x = +0.42 (right) and face each other."""

PLATE_XY = (0.0, -0.07)
PLATE_RADIUS_M = 0.078
PLATE_TOP_M = 0.008

BIN = Box(0.0, 0.165, 0.103, 0.103)
"""The middle line of the bin's walls."""
BIN_WALL_M = 0.003
"""Half the thickness of a wall."""
BIN_FLOOR_M = 0.006
BIN_TOP_M = 0.013

TUB = Box(0.0, -0.095, 0.103, 0.103)
"""The middle line of the tub's walls; it stands where the plate stands on the other table."""

CONTAINERS = {BIN_ROW: BIN, TUB_ROW: TUB}
"""By their rows; walls and floor of both are alike."""

TRAY = Box(0.0, 0.02, 0.335, 0.275)
"""The middle line of the tray's rim."""
RIM_M = 0.005
RIM_TOP_M = 0.010

SPACING_M = 0.092
"""Least distance between the centres of two objects at the start."""


def starts(rng: np.random.Generator, stock: Stock = KITCHEN) -> dict[int, tuple[float, ...]]:
    """Draw where the objects of a stock start: by row x, y, z [m], yaw [rad].

    They lie on both sides, 0.11 to 0.29 m off centre, clear of plate, bin and tub. All the food
    is always drawn, so that the same seed puts a thing at the same place, whatever else is there.
    Consumes `rng`.
    """
    drawn = rows(_whole_table(stock))
    beside = 0.17 if "tub" in stock else 0.12
    while True:
        spots = _scatter(rng, len(drawn), beside)
        if spots is not None:
            break
    yaws = rng.uniform(-np.pi / 4, np.pi / 4, len(drawn))
    places = {}
    for row, spot, yaw in zip(drawn, spots.tolist(), yaws.tolist(), strict=True):
        if OBJECTS[row].name in stock:
            places[row] = (*spot, OBJECTS[row].half_height_m + 0.001, yaw)
    return places


def _whole_table(stock: Stock) -> Stock:
    """All movable things of the table that a stock belongs to."""
    kinds = {item.kind for item in OBJECTS if item.name in stock} or {"food"}
    if kinds != {"food"}:
        kinds |= {"dish", "rubbish"}
    return frozenset(item.name for item in OBJECTS if item.kind in kinds)


def _scatter(rng: np.random.Generator, count: int, beside_m: float) -> np.ndarray | None:
    """Points, [count, 2], far enough apart; None where the draw ran into a corner.

    beside_m: how near to the middle a thing may lie beside plate or tub; 0.17 beside the bin.
    """
    sides = rng.permutation(np.resize([-1.0, 1.0], count))
    spots: list[np.ndarray] = []
    for side in sides:
        for _ in range(60):
            y = rng.uniform(-0.20, 0.17)
            spot = np.array([side * rng.uniform(beside_m if y < 0.01 else 0.17, 0.285), y])
            if all(np.hypot(*(spot - other)) >= SPACING_M for other in spots):
                spots.append(spot)
                break
        else:
            return None
    return np.array(spots)
