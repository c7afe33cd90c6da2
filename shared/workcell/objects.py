"""The things on the table: names, sizes and masses. Scene, expert and tasks agree on these."""

from dataclasses import dataclass
from typing import Literal

import numpy as np


@dataclass(frozen=True)
class Object:
    """One of the seven things that the arms can move.

    shape: a slice is a box, a disc is an upright cylinder.
    half_width_m: half the side of a slice, or the radius of a disc.
    half_height_m: half the thickness.
    """

    name: str
    shape: Literal["slice", "disc"]
    half_width_m: float
    half_height_m: float
    mass_kg: float


OBJECTS = (
    Object("bread", "slice", 0.029, 0.009, 0.040),
    Object("toast", "slice", 0.029, 0.009, 0.040),
    Object("cheese", "slice", 0.027, 0.008, 0.032),
    Object("ham", "slice", 0.028, 0.008, 0.032),
    Object("lettuce", "disc", 0.027, 0.008, 0.030),
    Object("tomato", "disc", 0.026, 0.009, 0.036),
    Object("onion", "disc", 0.026, 0.009, 0.036),
)
OBJECT_NAMES = tuple(item.name for item in OBJECTS)
FIXTURE_NAMES = ("plate", "bin")
BODY_NAMES = OBJECT_NAMES + FIXTURE_NAMES
"""Order of the rows of every array that holds one row a thing, [9, ...]."""

COUNT = len(OBJECTS)
PLATE = COUNT
BIN = COUNT + 1
HALF_HEIGHTS_M = np.array([item.half_height_m for item in OBJECTS])  # (7,)
HALF_HEIGHTS_M.setflags(write=False)


def index(name: str) -> int:
    """Row of the object called `name`."""
    return OBJECT_NAMES.index(name)
