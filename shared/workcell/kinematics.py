"""Forward and inverse kinematics of the two arms, in closed form; the expert's geometry.

ViperX 300, six joints an arm: waist (z), shoulder (y), elbow (y), forearm roll (x), wrist
angle (y), wrist rotate (x). The inverse keeps the gripper vertical and the forearm roll 0.
Arm 0 is the left one. Angles in [rad], lengths in [m].
"""

from math import acos, atan2, cos, hypot, pi, sin

import numpy as np

from shared.workcell.layout import BASE_X_M

ARM_NAMES = ("left", "right")
BASE_X = (-BASE_X_M, BASE_X_M)
BASE_YAW = (0.0, pi)

WAIST_HEIGHT_M = 0.079
SHOULDER_ABOVE_WAIST_M = 0.04805
SHOULDER_HEIGHT_M = WAIST_HEIGHT_M + SHOULDER_ABOVE_WAIST_M
ELBOW_FORWARD_M = 0.05955
ELBOW_UP_M = 0.300
ROLL_FORWARD_M = 0.200
WRIST_FORWARD_M = 0.100
ROTATE_FORWARD_M = 0.069744
TOOL_FORWARD_M = 0.1387

UPPER_M = hypot(ELBOW_FORWARD_M, ELBOW_UP_M)
UPPER_LEAN = atan2(ELBOW_FORWARD_M, ELBOW_UP_M)
FOREARM_M = ROLL_FORWARD_M + WRIST_FORWARD_M
HAND_M = ROTATE_FORWARD_M + TOOL_FORWARD_M
REACH_M = (UPPER_M + FOREARM_M) * 0.9995

JOINT_NAMES = ("waist", "shoulder", "elbow", "forearm_roll", "wrist_angle", "wrist_rotate")
JOINT_LOW = (-3.14158, -1.85005, -1.76278, -3.14158, -1.8675, -3.14158)
JOINT_HIGH = (3.14158, 1.25664, 1.6057, 3.14158, 2.23402, 3.14158)

GRIP_OPEN_M = 0.080
"""Gap between the pads of an open gripper."""
GRIP_CLOSED_M = -0.020
"""Target of a closing gripper: less than nothing, so that it squeezes."""


def wrap(angle: float, period: float = 2 * pi) -> float:
    """`angle` brought into [-period/2, period/2)."""
    return (angle + period / 2) % period - period / 2


def heading(arm: int, x: float, y: float) -> float:
    """Direction of a point as seen from the arm's base, in the world frame."""
    return atan2(y, x - BASE_X[arm])


def inverse(arm: int, x: float, y: float, z: float, rotate: float = 0.0) -> list[float]:
    """The six joints that put the tool at (x, y, z), pointing down, or as near as the arm goes.

    rotate: the wrist's last joint, which `rotation` computes from a yaw.
    """
    reach, height = hypot(x - BASE_X[arm], y), z + HAND_M - SHOULDER_HEIGHT_M
    distance = min(max(hypot(reach, height), 0.02), REACH_M)
    line = atan2(reach, height)
    lift = acos(_bound((UPPER_M**2 + distance**2 - FOREARM_M**2) / (2 * UPPER_M * distance)))
    fold = acos(_bound((FOREARM_M**2 + distance**2 - UPPER_M**2) / (2 * FOREARM_M * distance)))
    shoulder = line - lift - UPPER_LEAN
    pitch = line + fold - pi / 2
    waist = wrap(heading(arm, x, y) - BASE_YAW[arm])
    return [waist, shoulder, pitch - shoulder, 0.0, pi / 2 - pitch, rotate]


def rotation(arm: int, x: float, y: float, yaw: float) -> float:
    """Wrist rotation in [-pi/2, pi/2) that lays the line between the fingers along `yaw`."""
    return wrap(heading(arm, x, y) + pi / 2 - yaw, pi)


def forward(arm: int, joints: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Tool position [3] and rotation [3, 3] in the world frame, from six joints [6].

    Columns of the rotation: the pointing direction, the fingers' sliding axis, their normal.
    """
    waist, shoulder, elbow, roll, wrist, rotate = (float(joint) for joint in joints)
    turn = _about_z(BASE_YAW[arm] + waist)
    point = np.array([BASE_X[arm], 0.0, SHOULDER_HEIGHT_M])
    for step, rotated in (
        ((0.0, 0.0, 0.0), _about_y(shoulder)),
        ((ELBOW_FORWARD_M, 0.0, ELBOW_UP_M), _about_y(elbow)),
        ((ROLL_FORWARD_M, 0.0, 0.0), _about_x(roll)),
        ((WRIST_FORWARD_M, 0.0, 0.0), _about_y(wrist)),
        ((ROTATE_FORWARD_M, 0.0, 0.0), _about_x(rotate)),
        ((TOOL_FORWARD_M, 0.0, 0.0), np.eye(3)),
    ):
        point = point + turn @ np.array(step)
        turn = turn @ rotated
    return point, turn


def tool_yaw(turn: np.ndarray) -> float:
    """Yaw of the fingers' sliding axis, from the tool's rotation [3, 3]."""
    return atan2(float(turn[1, 1]), float(turn[0, 1]))


def _bound(cosine: float) -> float:
    return max(-1.0, min(1.0, cosine))


def _about_x(angle: float) -> np.ndarray:
    c, s = cos(angle), sin(angle)
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


def _about_y(angle: float) -> np.ndarray:
    c, s = cos(angle), sin(angle)
    return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])


def _about_z(angle: float) -> np.ndarray:
    c, s = cos(angle), sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
