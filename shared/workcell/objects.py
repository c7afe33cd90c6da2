"""The things on the tables: names, sizes, masses, colours. Scene, expert and tasks agree."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np

Shape = Literal["slice", "disc", "block"]
Kind = Literal["food", "dish", "rubbish"]


@dataclass(frozen=True)
class Object:
    """One of the fifteen things that the arms can move.

    shape: a slice is a square board, a disc an upright cylinder; a block is longer than wide, lies
    on any side, and is gripped across its width.
    half_width_m: half the side of a slice, the radius of a disc, half the width of a block.
    half_height_m: half the thickness. half_length_m: half the length of a block, else the width's.
    colour: what people call its colour.
    """

    name: str
    shape: Shape
    half_width_m: float
    half_height_m: float
    mass_kg: float
    kind: Kind
    colour: str
    half_length_m: float

    @property
    def half_sizes_m(self) -> tuple[float, float, float]:
        """Half of width, length and height."""
        return self.half_width_m, self.half_length_m, self.half_height_m


def _food(name: str, shape: Shape, width: float, height: float, mass: float, colour: str) -> Object:
    return Object(name, shape, width, height, mass, "food", colour, width)


OBJECTS = (
    _food("bread", "slice", 0.029, 0.009, 0.040, "brown"),
    _food("toast", "slice", 0.029, 0.009, 0.040, "brown"),
    _food("cheese", "slice", 0.027, 0.008, 0.032, "yellow"),
    _food("ham", "slice", 0.028, 0.008, 0.032, "pink"),
    _food("lettuce", "disc", 0.027, 0.008, 0.030, "green"),
    _food("tomato", "disc", 0.026, 0.009, 0.036, "red"),
    _food("onion", "disc", 0.026, 0.009, 0.036, "purple"),
    Object("cup", "block", 0.022, 0.022, 0.060, "dish", "red", 0.027),
    Object("bowl", "disc", 0.032, 0.014, 0.070, "dish", "blue", 0.032),
    Object("glass", "block", 0.019, 0.019, 0.055, "dish", "green", 0.033),
    Object("saucer", "disc", 0.030, 0.008, 0.050, "dish", "white", 0.030),
    Object("can", "block", 0.020, 0.020, 0.030, "rubbish", "red", 0.033),
    Object("wrapper", "block", 0.015, 0.009, 0.020, "rubbish", "yellow", 0.032),
    Object("carton", "block", 0.021, 0.016, 0.030, "rubbish", "blue", 0.030),
    Object("napkin", "slice", 0.027, 0.008, 0.025, "rubbish", "white", 0.027),
)
OBJECT_NAMES = tuple(item.name for item in OBJECTS)
FIXTURE_NAMES = ("plate", "bin", "tub")
BODY_NAMES = OBJECT_NAMES + FIXTURE_NAMES
"""Order of the rows of every array that holds one row a thing, [18, ...]."""

COUNT = len(OBJECTS)
PLATE, BIN, TUB = range(COUNT, COUNT + 3)
HALF_HEIGHTS_M = np.array([item.half_height_m for item in OBJECTS])  # (15,)
HALF_HEIGHTS_M.setflags(write=False)

KINDS: dict[Kind, tuple[str, ...]] = {
    kind: tuple(item.name for item in OBJECTS if item.kind == kind)
    for kind in ("food", "dish", "rubbish")
}

Stock = frozenset[str]
"""The names of all that is in the cell in an episode, fixtures too."""
KITCHEN: Stock = frozenset((*KINDS["food"], "plate", "bin"))
TABLE: Stock = frozenset((*KINDS["dish"], *KINDS["rubbish"], "bin", "tub"))


def index(name: str) -> int:
    """Row of the object called `name`."""
    return OBJECT_NAMES.index(name)


def rows(stock: Iterable[str]) -> list[int]:
    """Rows of the movable things of a stock, in order."""
    return sorted(index(name) for name in stock if name in OBJECT_NAMES)


def absent_at(row: int) -> tuple[float, float, float]:
    """Where a body that isn't in the cell hovers: far away, and far from every other. [m]"""
    return (30.0 + 2.0 * row, 30.0, 5.0)


ABSENT_Z_M = 2.0
"""A body above this height isn't in the cell."""
