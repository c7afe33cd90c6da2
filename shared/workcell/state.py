"""The true state of the cell: what the expert, the tasks and the oracle know, as plain arrays.

Letters: two arms, left first; 18 bodies in the order of `objects.BODY_NAMES`, the fifteen objects
before plate, bin and tub; 14 joints, seven an arm, the gripper last. Lengths in [m], angles in
[rad], quaternions w x y z, all in the world frame. What isn't in the cell is far away, at
`objects.absent_at`, so that no rule takes it for near; `present` tells.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from math import hypot
from typing import Any

import numpy as np

from shared.workcell.errors import InvalidState
from shared.workcell.layout import CONTAINERS, PLATE_RADIUS_M, PLATE_TOP_M
from shared.workcell.objects import (
    ABSENT_Z_M,
    BIN,
    BODY_NAMES,
    COUNT,
    HALF_HEIGHTS_M,
    OBJECTS,
    PLATE,
    TUB,
)

LEVEL_M = 0.007
"""How far an object's height may be off the top that it is said to lie on."""
CENTRE_M = 0.022
"""How far from the plate's middle an object of the stack may lie."""
BELOW_M = 0.032
"""How far from the middle of the one below; a hand that aims at the plate's middle keeps both."""
FLAT = 0.97
STANDING = 0.6
"""An object lies flat above the one, stands on its edge below the other; see `tilts`."""
IN_M = 0.090
"""What lies in the bin or the tub has its centre below this."""
COVER_M = 0.045
"""Two objects closer than this, seen from above, cover one another."""

_BLOCKS = [row for row, item in enumerate(OBJECTS) if item.shape == "block"]
_BLOCK_SIZES = np.array([OBJECTS[row].half_sizes_m for row in _BLOCKS])  # (4, 3)

Shape = tuple[int, ...]
SHAPES: dict[str, tuple[Shape, str]] = {
    "joints": ((14,), "float64"),
    "tools": ((2, 4), "float64"),
    "positions": ((len(BODY_NAMES), 3), "float64"),
    "quaternions": ((len(BODY_NAMES), 4), "float64"),
    "held": ((2,), "int64"),
}


@dataclass(frozen=True, eq=False)
class CellState:
    """One moment of the cell. The arrays must not be changed.

    joints: [14] measured joints; an arm's last is the gap between its pads.
    tools: [2, 4] x, y, z and yaw of each tool; the yaw is that of the line between the fingers.
    positions: [18, 3] centres of the objects, of plate, bin and tub.
    quaternions: [18, 4] their orientations.
    held: [2] index of the object between each arm's pads, -1 for none.
    """

    joints: np.ndarray
    tools: np.ndarray
    positions: np.ndarray
    quaternions: np.ndarray
    held: np.ndarray

    def to_arrays(self) -> dict[str, np.ndarray]:
        """The fields by name, to travel in a message."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, np.ndarray]) -> "CellState":
        """The state back from its arrays.

        Raises:
            InvalidState: an array is missing, unknown, or has another shape or type.
        """
        if set(arrays) != set(SHAPES):
            raise InvalidState(f"a state has {', '.join(SHAPES)}; got {', '.join(arrays)}")
        for name, (shape, dtype) in SHAPES.items():
            got = arrays[name]
            if got.shape != shape or got.dtype != dtype:
                raise InvalidState(f"{name} is {dtype} {shape}; got {got.dtype} {got.shape}")
        return cls(**arrays)

    def to_json(self) -> dict[str, Any]:
        """The fields as nested lists, exact to the bit, for a message without arrays."""
        return {name: array.tolist() for name, array in self.to_arrays().items()}

    @classmethod
    def from_json(cls, lists: Mapping[str, Any]) -> "CellState":
        """The state back from `to_json`.

        Raises:
            InvalidState: as `from_arrays`.
        """
        types = {name: dtype for name, (_, dtype) in SHAPES.items()}
        try:
            arrays = {name: np.array(rows, types.get(name)) for name, rows in lists.items()}
        except (TypeError, ValueError) as error:
            raise InvalidState(f"a state is lists of numbers: {error}") from error
        return cls.from_arrays(arrays)

    @cached_property
    def points(self) -> list[list[float]]:
        """Positions as plain numbers, which scalar code reads faster."""
        return self.positions.tolist()  # type: ignore[no-any-return]

    @cached_property
    def holding(self) -> frozenset[int]:
        """Objects between the pads of either arm."""
        return frozenset(int(item) for item in self.held if item >= 0)

    @cached_property
    def present(self) -> np.ndarray:
        """Which bodies are in the cell. [18] bool"""
        there: np.ndarray = self.positions[:, 2] < ABSENT_Z_M
        return there

    @cached_property
    def tilts(self) -> list[float]:
        """|cos| of each object's tilt: 1 lies flat, 0 stands on its edge; 1 for blocks. [15]

        A block lies well on any side, also on its end.
        """
        x, y = self.quaternions[:COUNT, 1], self.quaternions[:COUNT, 2]
        tilts = np.abs(1.0 - 2.0 * (x * x + y * y))
        tilts[_BLOCKS] = 1.0
        return tilts.tolist()  # type: ignore[no-any-return]

    @cached_property
    def half_heights(self) -> list[float]:
        """How far each object reaches up and down from its centre; a block on any side. [15]"""
        heights = HALF_HEIGHTS_M.copy()
        w, x, y, z = self.quaternions[_BLOCKS].T
        upward = np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], 1)
        heights[_BLOCKS] = (np.abs(upward) * _BLOCK_SIZES).sum(1)
        return heights.tolist()  # type: ignore[no-any-return]


def held_object(state: CellState) -> int | None:
    """The object in a hand, the left one's first; None when both are empty."""
    return next((int(item) for item in state.held if item >= 0), None)


def stack_on_plate(state: CellState) -> tuple[int, ...]:
    """Objects that lie flat one upon another on the plate, from bottom to top."""
    points, plate = state.points, state.points[PLATE]
    below, top = plate, PLATE_TOP_M
    stack: list[int] = []
    for item in sorted(near_plate(state), key=lambda item: points[item][2]):
        at, half = points[item], float(HALF_HEIGHTS_M[item])
        centred = _apart(at, plate) < CENTRE_M and _apart(at, below) < BELOW_M
        if centred and abs(at[2] - half - top) < LEVEL_M and state.tilts[item] > FLAT:
            stack.append(item)
            below, top = at, at[2] + half
    return tuple(stack)


def _apart(one: list[float], other: list[float]) -> float:
    """Distance of two points seen from above."""
    return hypot(one[0] - other[0], one[1] - other[1])


def near_plate(state: CellState) -> frozenset[int]:
    """Objects in no hand whose centre is over the plate or close beside it."""
    plate, limit = state.points[PLATE], PLATE_RADIUS_M + 0.02
    return frozenset(
        item
        for item, at in enumerate(state.points[:COUNT])
        if item not in state.holding and _apart(at, plate) < limit
    )


def astray_on_plate(state: CellState) -> tuple[int, ...]:
    """Objects on the plate that are no part of the stack, the highest first."""
    astray = near_plate(state) - set(stack_on_plate(state))
    return tuple(sorted(astray, key=lambda item: (-state.points[item][2], item)))


def inside(state: CellState, container: int) -> frozenset[int]:
    """Objects that lie in the bin or the tub; one that a hand holds over it does not count.

    container: the row of `BIN` or `TUB`.
    """
    points, holding = state.points, state.holding
    return frozenset(
        item
        for item in range(COUNT)
        if points[item][2] < IN_M and over(state, item, container) and item not in holding
    )


def over(state: CellState, item: int, container: int) -> bool:
    """Whether the centre of a thing is above the bin or the tub, at any height."""
    at, middle, box = state.points[item], state.points[container], CONTAINERS[container]
    return abs(at[0] - middle[0]) < box.half_x_m and abs(at[1] - middle[1]) < box.half_y_m


def in_bin(state: CellState) -> frozenset[int]:
    """Objects that lie in the bin."""
    return inside(state, BIN)


def in_tub(state: CellState) -> frozenset[int]:
    """Objects that lie in the tub."""
    return inside(state, TUB)


def cover_of(state: CellState, item: int) -> int | None:
    """The topmost object that lies on `item`; None when it is free."""
    at = state.points[item]
    covers = [
        other
        for other, place in enumerate(state.points[:COUNT])
        if other not in state.holding and place[2] > at[2] + 0.006 and _apart(place, at) < COVER_M
    ]
    return max(covers, key=lambda other: state.points[other][2], default=None)


def top_at(state: CellState, x: float, y: float, floor_m: float, skip: int = -1) -> float:
    """Height of the highest thing lying around (x, y), at least `floor_m`. [m]"""
    top = floor_m
    for item, (ox, oy, oz) in enumerate(state.points[:COUNT]):
        near = (ox - x) ** 2 + (oy - y) ** 2 < 0.055**2
        if near and item != skip and item not in state.holding:
            top = max(top, oz + state.half_heights[item])
    return top


def on_table(state: CellState, item: int) -> bool:
    """Whether the object lies on the table: in no hand, not on the plate, in no container."""
    free = item not in state.holding and item not in near_plate(state)
    packed = any(over(state, item, container) for container in CONTAINERS)
    return free and not packed and state.points[item][2] < IN_M
