"""The scripted expert of the low level: state and command in, the next joint targets out.

Markov: no timer and no memory, so it relabels any state and retries by itself. A hand descends
only through a funnel above its goal and travels only when it is high enough.
"""

from dataclasses import dataclass
from math import cos, hypot, pi, sin

import numpy as np

from shared.workcell import placing
from shared.workcell.kinematics import (
    GRIP_CLOSED_M,
    GRIP_OPEN_M,
    inverse,
    rotation,
)
from shared.workcell.objects import index
from shared.workcell.skills import Skill
from shared.workcell.state import STANDING, CellState

STEP_M = 0.022
TURN_RAD = 0.2
"""The most that a tool moves and turns in one control step."""
JOINT_RAD = 0.3
"""The most that any joint's target lies from its measured angle."""

LIFT_M = 0.160
FUNNEL_M = 0.120
AIM_M = 0.007
"""Within this distance of its axis a hand goes straight down."""
HOME = ((-0.33, 0.20, 0.22), (0.33, 0.20, 0.22))


@dataclass(frozen=True)
class Goal:
    """Where a tool shall go: x, y, z [m], the wrist's last joint [rad], the pads' gap [m]."""

    x: float
    y: float
    z: float
    rotate: float
    gap: float


def act(state: CellState, skill: Skill) -> np.ndarray:
    """The next joint targets, [14], for this command in this state."""
    goals = [_rest(state, 0), _rest(state, 1)]
    chosen = _work(state, skill)
    if chosen is not None:
        goals[chosen[0]] = chosen[1]
    return np.array([*_steer(state, 0, goals[0]), *_steer(state, 1, goals[1])])


def _work(state: CellState, skill: Skill) -> tuple[int, Goal] | None:
    """The arm that has something to do, and its goal; None when both go home."""
    if skill.verb == "wait":
        return None
    arm = placing.busy_arm(state)
    if skill.verb != "pick" or skill.object is None:
        return None if arm is None else (arm, _put(state, arm, skill.verb))
    item = index(skill.object)
    if not state.present[item]:
        return None
    if arm is None:
        arm = placing.picking_arm(state, item)
        reach = _topple if state.tilts[item] < STANDING else _pick
        return arm, reach(state, arm, item)
    if int(state.held[arm]) == item:
        return arm, _lift(state, arm)
    return arm, _put(state, arm, "down")


def _rest(state: CellState, arm: int) -> Goal:
    x, y, z = HOME[arm]
    gap = GRIP_CLOSED_M if state.held[arm] >= 0 else GRIP_OPEN_M
    return Goal(x, y, z, 0.0, gap)


def _lift(state: CellState, arm: int) -> Goal:
    x, y, _, _ = state.tools[arm].tolist()
    return Goal(x, y, LIFT_M, float(state.joints[7 * arm + 5]), GRIP_CLOSED_M)


def _pick(state: CellState, arm: int, item: int) -> Goal:
    """Above the object, down through the funnel, close."""
    x, y, z = state.points[item]
    yaw = placing.grasp_yaw(state, arm, item)
    rotate, gap = _rotate_to(state, arm, x, y, yaw), float(state.joints[7 * arm + 6])
    depth = placing.grasp_height(state, x, y, z, yaw)
    offset, turn = _errors(state, arm, x, y, rotate)
    off_height = abs(float(state.tools[arm, 2]) - depth)
    limit = AIM_M if gap > 0.074 else 0.014
    close = offset < limit and turn < 0.3 and off_height < 0.006
    height = depth + _funnel(offset, turn, limit)
    return Goal(x, y, height, rotate, GRIP_CLOSED_M if close else GRIP_OPEN_M)


def _topple(state: CellState, arm: int, item: int) -> Goal:
    """Astride an object that stands on its edge, then sideways, so that a finger pushes it over."""
    x, y, z = state.points[item]
    yaw = placing.fall_yaw(state, item)
    rotate = _rotate_to(state, arm, x, y, yaw)
    tool_x, tool_y, tool_z, _ = state.tools[arm].tolist()
    along = (tool_x - x) * cos(yaw) + (tool_y - y) * sin(yaw)
    across = (tool_y - y) * cos(yaw) - (tool_x - x) * sin(yaw)
    depth = z + 0.008
    if tool_z - depth < 0.012 and abs(across) < 0.012 and -0.012 < along < 0.060:
        return Goal(x + 0.08 * cos(yaw), y + 0.08 * sin(yaw), depth, rotate, GRIP_OPEN_M)
    offset, turn = _errors(state, arm, x, y, rotate)
    return Goal(x, y, depth + _funnel(offset, turn, AIM_M), rotate, GRIP_OPEN_M)


def _put(state: CellState, arm: int, verb: str) -> Goal:
    """Above the place, down through the funnel, open."""
    item = int(state.held[arm])
    spot = placing.place(state, arm, verb, item)
    (item_x, item_y, item_z), tool = state.points[item], state.tools[arm].tolist()
    x, y = spot.x + tool[0] - item_x, spot.y + tool[1] - item_y
    yaw = tool[3] - placing.misturn(state, item, tool[3])
    rotate = _rotate_to(state, arm, x, y, yaw)
    offset, turn = _errors(state, arm, x, y, rotate)
    depth = spot.z + 0.004 + tool[2] - item_z
    release = offset < 0.009 and abs(tool[2] - depth) < 0.006
    height = depth + _funnel(offset, turn, AIM_M)
    return Goal(x, y, height, rotate, GRIP_OPEN_M if release else GRIP_CLOSED_M)


def _funnel(offset: float, turn: float, aim: float) -> float:
    return min(max(4.0 * (offset + 0.04 * turn - aim), 0.0), FUNNEL_M)


def _errors(state: CellState, arm: int, x: float, y: float, rotate: float) -> tuple[float, float]:
    """How far the tool is from the goal's axis [m], and how far from its turn [rad]."""
    tool_x, tool_y, _, _ = state.tools[arm].tolist()
    turn = abs(rotate - float(state.joints[7 * arm + 5]))
    return hypot(x - tool_x, y - tool_y), turn


def _rotate_to(state: CellState, arm: int, x: float, y: float, yaw: float) -> float:
    """Wrist rotation for this yaw, a half turn being the same; near to now, near to 0."""
    now, first = float(state.joints[7 * arm + 5]), rotation(arm, x, y, yaw)
    choices = [first + turns * pi for turns in (-1, 0, 1) if abs(first + turns * pi) < 2.2]
    return min(choices, key=lambda rotate: abs(rotate - now) + 0.5 * abs(rotate))


def _steer(state: CellState, arm: int, goal: Goal) -> list[float]:
    """Seven joint targets one clipped step from the measured pose towards the goal."""
    joints = state.joints[7 * arm : 7 * arm + 7].tolist()
    x, y, z, _ = state.tools[arm].tolist()
    dx, dy, dz = goal.x - x, goal.y - y, goal.z - z
    free = min(max(1.0 - (dz - 0.010) / 0.040, 0.0), 1.0)
    dx, dy = dx * free, dy * free
    scale = min(1.0, STEP_M / max((dx * dx + dy * dy + dz * dz) ** 0.5, 1e-9))
    turn = min(max(goal.rotate - joints[5], -TURN_RAD), TURN_RAD)
    x, y, z = x + dx * scale, y + dy * scale, z + dz * scale
    wanted = inverse(arm, x, y, z, joints[5] + turn)
    near = [
        now + min(max(target - now, -JOINT_RAD), JOINT_RAD)
        for now, target in zip(joints[:6], wanted, strict=True)
    ]
    return [*near, goal.gap]
