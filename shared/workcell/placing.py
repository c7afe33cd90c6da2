"""Which arm, which turn of the hand, which height, which free spot: the expert's choices."""

from dataclasses import dataclass
from math import atan2, cos, hypot, pi, sin

from shared.workcell.kinematics import wrap
from shared.workcell.layout import (
    BIN_FLOOR_M,
    BIN_TOP_M,
    BIN_WALL_M,
    CONTAINERS,
    PLATE_RADIUS_M,
    PLATE_TOP_M,
    RIM_M,
    RIM_TOP_M,
    TRAY,
    Box,
)
from shared.workcell.objects import BIN, COUNT, OBJECTS, PLATE, TUB
from shared.workcell.state import CellState, top_at

PAD_BELOW_M = 0.005
"""How far the pads reach below the tool's centre."""
PAD_HALF_M = (0.015, 0.005, 0.011)
"""Half sizes of a pad: along the finger, along its slide, across."""
PAD_MARGIN_M = 0.002
FINGERS_M = (0.032, 0.039, 0.045)
"""Where the middle of a finger passes while it closes, from the tool's centre."""

SLOT_M = 0.047
"""Offset of the four quarters of bin and tub from their middle, along x and y."""
_BESIDE_BIN = tuple((x, y) for y in (0.08, 0.17) for x in (0.175, 0.285))
FREE_SPOTS = (
    *((x, y) for y in (-0.19, -0.10, -0.01) for x in (0.14, 0.215, 0.285)),
    *_BESIDE_BIN,
)
"""Where an arm puts things down, x counted from the middle of the table to the arm's own side."""
TUB_SPOTS = (
    *((x, y) for y in (-0.19, -0.10, -0.01) for x in (0.175, 0.285)),
    *_BESIDE_BIN,
)
"""The same where the tub stands."""


@dataclass(frozen=True)
class Spot:
    """Where an object's centre shall come to rest, [m]."""

    x: float
    y: float
    z: float


def busy_arm(state: CellState) -> int | None:
    """The arm that holds something, the left one first."""
    return next((arm for arm in (0, 1) if state.held[arm] >= 0), None)


def picking_arm(state: CellState, item: int) -> int:
    """The arm to pick with: the nearer tool, and not far beyond the middle of the table."""
    x, y, _ = state.points[item]

    def cost(arm: int) -> float:
        beyond = x if arm == 0 else -x
        tool_x, tool_y, _, _ = state.tools[arm].tolist()
        return hypot(x - tool_x, y - tool_y) + 3.0 * max(0.0, beyond - 0.05)

    return 0 if cost(0) <= cost(1) else 1


def item_yaw(state: CellState, item: int) -> float:
    """Turn of an object's sides in [-pi/4, pi/4); 0 for a disc."""
    shape = OBJECTS[item].shape
    if shape == "disc":
        return 0.0
    if shape == "block":
        return wrap(_grips(state, item)[0], pi / 2)
    w, x, y, z = state.quaternions[item].tolist()
    across_x, across_y = 1 - 2 * (y * y + z * z), 2 * (x * y + w * z)
    return wrap(atan2(across_y, across_x), pi / 2)


def _grips(state: CellState, item: int) -> list[float]:
    """Yaws along which a block can be gripped: its short axes that lie level, on any side."""
    w, x, y, z = state.quaternions[item].tolist()
    wide = (1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y))
    high = (2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y))
    axes = sorted((wide, high), key=lambda axis: abs(axis[2]))
    level = [axis for axis in axes if abs(axis[2]) < 0.5] or axes[:1]
    return [atan2(axis[1], axis[0]) for axis in level]


def fall_yaw(state: CellState, item: int) -> float:
    """The direction in which an object that stands on its edge can be pushed over."""
    w, x, y, z = state.quaternions[item].tolist()
    return atan2(2 * (y * z - w * x), 2 * (x * z + w * y))


def misturn(state: CellState, item: int, tool_yaw: float) -> float:
    """How far a held object's sides are from the table's axes, in [-pi/4, pi/4)."""
    if OBJECTS[item].shape == "disc":
        return wrap(tool_yaw, pi / 2)
    return item_yaw(state, item)


def grasp_yaw(state: CellState, arm: int, item: int) -> float:
    """Yaw of the line between the fingers: along a side, where the fingers have room."""
    tool_yaw = float(state.tools[arm, 3])

    def cost(yaw: float) -> float:
        return abs(wrap(yaw - tool_yaw, pi)) + 4.0 * crowding(state, item, yaw)

    return min(_grasps(state, item), key=cost)


def _grasps(state: CellState, item: int) -> list[float]:
    """Yaws along which the object can be gripped."""
    shape, first = OBJECTS[item].shape, item_yaw(state, item)
    if shape == "block":
        return _grips(state, item)
    quarters = (0, 2) if shape == "slice" else (0, 2, 1, 3)
    return [first + quarter * pi / 4 for quarter in quarters]


def crowding(state: CellState, item: int, yaw: float) -> float:
    """How badly the fingers would hit other things: 0 free, 1 a thing in the way."""
    x, y, z = state.points[item]
    raised = grasp_height(state, x, y, z, yaw) - z
    worst = 0.0 if raised < 0.002 else 0.2 if raised < 0.009 else 1.0
    for side in (-0.044, 0.044):
        fx, fy = x + side * cos(yaw), y + side * sin(yaw)
        for other, (ox, oy, oz) in enumerate(state.points[:COUNT]):
            if other != item and abs(oz - z) < 0.03:
                worst = max(worst, min(1.0, (0.046 - hypot(ox - fx, oy - fy)) / 0.02))
    return worst


def grasp_height(state: CellState, x: float, y: float, z: float, yaw: float) -> float:
    """Height of the tool for a grasp: the object's middle, unless a finger stands on something."""
    along, across = abs(cos(yaw)), abs(sin(yaw))
    half_x = PAD_HALF_M[1] * along + PAD_HALF_M[2] * across + PAD_MARGIN_M
    half_y = PAD_HALF_M[1] * across + PAD_HALF_M[2] * along + PAD_MARGIN_M
    floor = 0.0
    for reach in FINGERS_M:
        for side in (-reach, reach):
            at_x, at_y = x + side * cos(yaw), y + side * sin(yaw)
            floor = max(floor, _ground(state, at_x, at_y, half_x, half_y))
    return max(z, floor + PAD_BELOW_M + 0.001)


def _ground(state: CellState, x: float, y: float, half_x: float, half_y: float) -> float:
    """Height of the furniture under a finger whose middle is (x, y)."""
    for row in CONTAINERS:
        box = _box(state, row)
        if box.on_edge(x, y, half_x + BIN_WALL_M, half_y + BIN_WALL_M):
            return BIN_TOP_M
        if box.contains(x, y):
            return BIN_FLOOR_M
    if TRAY.on_edge(x, y, half_x + RIM_M, half_y + RIM_M):
        return RIM_TOP_M
    plate_x, plate_y, _ = state.points[PLATE]
    on_plate = hypot(x - plate_x, y - plate_y) < PLATE_RADIUS_M + 0.008
    return PLATE_TOP_M if on_plate else 0.0


def _box(state: CellState, row: int) -> Box:
    """Bin or tub where it stands now."""
    x, y, _ = state.points[row]
    return Box(x, y, CONTAINERS[row].half_x_m, CONTAINERS[row].half_y_m)


def place(state: CellState, arm: int, verb: str, item: int) -> Spot:
    """Where the held object goes: on the stack, into a free quarter, onto a free spot.

    What is to go on a plate, or into a bin or tub, that isn't there is put down.
    """
    row = {"plate": PLATE, "bin": BIN, "tub": TUB}.get(verb)
    if row is None or not state.present[row]:
        x, y = _free_spot(state, arm)
        floor = 0.0
    elif row == PLATE:
        x, y, _ = state.points[PLATE]
        floor = PLATE_TOP_M
    else:
        x, y = _quarter(state, arm, row)
        floor = BIN_FLOOR_M
    return Spot(x, y, top_at(state, x, y, floor, item) + state.half_heights[item])


def _quarter(state: CellState, arm: int, row: int) -> tuple[float, float]:
    """The lowest quarter of bin or tub; where equal, the arm's own side, the far row."""
    box_x, box_y, _ = state.points[row]
    side = -SLOT_M if arm == 0 else SLOT_M
    slots = [(box_x + x, box_y + y) for x in (side, -side) for y in (SLOT_M, -SLOT_M)]
    return min(slots, key=lambda slot: round(top_at(state, slot[0], slot[1], BIN_FLOOR_M), 2))


def _free_spot(state: CellState, arm: int) -> tuple[float, float]:
    """The free spot on the arm's side of the table that is nearest to its tool."""
    tool_x, tool_y, _, _ = state.tools[arm].tolist()
    side = -1.0 if arm == 0 else 1.0

    def cost(spot: tuple[float, float]) -> float:
        x, y = spot
        return hypot(x - tool_x, y - tool_y) + 2.0 * _occupied(state, x, y)

    spots = TUB_SPOTS if state.present[TUB] else FREE_SPOTS
    return min(((side * x, y) for x, y in spots), key=cost)


def _occupied(state: CellState, x: float, y: float) -> float:
    """0 for a free spot, growing to 1 as another object comes nearer than 0.085 m."""
    gaps = [
        hypot(ox - x, oy - y)
        for item, (ox, oy, _) in enumerate(state.points[:COUNT])
        if item not in state.holding
    ]
    return max(0.0, 1.0 - min(gaps, default=1.0) / 0.085)
