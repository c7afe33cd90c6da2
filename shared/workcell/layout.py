"""Where things stand: the fixed furniture of the cell, in metres, and the random start.

World frame: origin at the middle of the table top, x to the right arm, y away from the person,
z up. The tray's rim keeps the objects where an arm can reach them.
"""

from dataclasses import dataclass

import numpy as np

from shared.workcell.objects import COUNT, OBJECTS


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

TRAY = Box(0.0, 0.02, 0.335, 0.275)
"""The middle line of the tray's rim."""
RIM_M = 0.005
RIM_TOP_M = 0.010

SPACING_M = 0.092
"""Least distance between the centres of two objects at the start."""


def starts(rng: np.random.Generator) -> np.ndarray:
    """Draw the seven starting poses, [7, 4]: x, y, z [m], yaw [rad].

    Objects lie on both sides of the plate, 0.11 to 0.29 m off centre. Consumes `rng`.
    """
    while True:
        spots = _scatter(rng)
        if spots is not None:
            break
    yaws = rng.uniform(-np.pi / 4, np.pi / 4, COUNT)
    heights = [item.half_height_m + 0.001 for item in OBJECTS]
    return np.column_stack([spots, heights, yaws])


def _scatter(rng: np.random.Generator) -> np.ndarray | None:
    """Seven points, [7, 2], far enough apart; None where the draw ran into a corner."""
    sides = rng.permutation(np.resize([-1.0, 1.0], COUNT))
    spots: list[np.ndarray] = []
    for side in sides:
        for _ in range(60):
            y = rng.uniform(-0.20, 0.17)
            spot = np.array([side * rng.uniform(0.12 if y < 0.01 else 0.17, 0.285), y])
            if all(np.hypot(*(spot - other)) >= SPACING_M for other in spots):
                spots.append(spot)
                break
        else:
            return None
    return np.array(spots)
