"""One ViperX-300 arm as MJCF: capsules for links, boxes for fingers. Numbers: kinematics.py."""

from shared.workcell.kinematics import (
    ARM_NAMES,
    BASE_X,
    BASE_YAW,
    ELBOW_FORWARD_M,
    ELBOW_UP_M,
    JOINT_HIGH,
    JOINT_LOW,
    JOINT_NAMES,
    ROLL_FORWARD_M,
    ROTATE_FORWARD_M,
    SHOULDER_ABOVE_WAIST_M,
    TOOL_FORWARD_M,
    WAIST_HEIGHT_M,
    WRIST_FORWARD_M,
)
from shared.workcell.placing import PAD_BELOW_M, PAD_HALF_M

FINGER_FORWARD_M = 0.0687
FINGER_TRAVEL_M = 0.045
_STIFFNESS = (800, 1600, 800, 100, 150, 80)


def arm_xml(arm: int) -> str:
    """The body tree of one arm, its base on the table."""
    name, yaw = ARM_NAMES[arm], BASE_YAW[arm]
    upper = _link(name, 1, f"0 0 {SHOULDER_ABOVE_WAIST_M}", "0 1 0", 0.793, _UPPER, _elbow(name))
    waist = _link(name, 0, f"0 0 {WAIST_HEIGHT_M}", "0 0 1", 0.799, _WAIST, upper)
    return f"""
    <body name="{name}" pos="{BASE_X[arm]} 0 0" euler="0 0 {yaw}" childclass="arm">
      <geom class="look" type="cylinder" size=".062 .012" pos="0 0 .012" material="graphite"/>
      <geom class="look" type="cylinder" size=".064 .003" pos="0 0 .026" material="{name}"/>
      <geom class="link" type="capsule" size=".046" fromto="0 0 .010 0 0 .050" material="metal"/>
      {waist}
    </body>""".replace("ACCENT", name)


def actuators_xml(arm: int) -> str:
    """Seven position actuators, the gripper last, and the joint that couples the fingers."""
    name = ARM_NAMES[arm]
    joints = "".join(
        f'<position name="{name}_{joint}" joint="{name}_{joint}" kp="{kp}" dampratio="1" '
        f'ctrlrange="{low} {high}"/>'
        for joint, kp, low, high in zip(JOINT_NAMES, _STIFFNESS, JOINT_LOW, JOINT_HIGH, strict=True)
    )
    return joints + (
        f'<position name="{name}_gripper" joint="{name}_finger_a" kp="400" kv="20" '
        f'ctrlrange="-.01 .04" forcerange="-25 25"/>'
    )


def coupling_xml(arm: int) -> str:
    """The equality that moves the second finger like the first."""
    name = ARM_NAMES[arm]
    return (
        f'<joint joint1="{name}_finger_b" joint2="{name}_finger_a" polycoef="0 1 0 0 0" '
        f'solref=".004 1"/>'
    )


_WAIST = """
<geom class="look" type="cylinder" size=".040 .022" pos="0 0 -.004" material="graphite"/>
<geom class="link" type="capsule" size=".034" fromto="0 0 0 0 0 .048" material="graphite"/>
<geom class="look" type="cylinder" size=".037 .046" pos="0 0 .048" euler="1.5708 0 0"
  material="metal"/>
<geom class="look" type="cylinder" size=".028 .049" pos="0 0 .048" euler="1.5708 0 0"
  material="ACCENT"/>"""
_UPPER = """
<geom class="link" type="capsule" size=".027" fromto="0 0 .03 0 0 .29" material="graphite"/>
<geom class="look" type="capsule" size=".029" fromto="0 0 .10 0 0 .20" material="ACCENT"/>
<geom class="look" type="capsule" size=".027" fromto="0 0 .29 .0595 0 .30" material="graphite"/>
<geom class="look" type="cylinder" size=".034 .038" pos=".0595 0 .30" euler="1.5708 0 0"
  material="metal"/>
<geom class="look" type="cylinder" size=".025 .041" pos=".0595 0 .30" euler="1.5708 0 0"
  material="ACCENT"/>"""
_FOREARM = """
<geom class="link" type="capsule" size=".024" fromto=".01 0 0 .19 0 0" material="graphite"/>
<geom class="look" type="cylinder" size=".026 .012" pos=".17 0 0" euler="0 1.5708 0"
  material="ACCENT"/>"""
_ROLL = """
<geom class="link" type="capsule" size=".021" fromto="0 0 0 .085 0 0" material="graphite"/>
<geom class="look" type="cylinder" size=".026 .028" pos=".1 0 0" euler="1.5708 0 0"
  material="metal"/>
<geom class="look" type="cylinder" size=".018 .031" pos=".1 0 0" euler="1.5708 0 0"
  material="ACCENT"/>"""
_WRIST = """
<geom class="link" type="capsule" size=".019" fromto=".01 0 0 .06 0 0" material="graphite"/>"""
_HAND = """
<geom class="look" type="cylinder" size=".027 .010" pos=".008 0 0" euler="0 1.5708 0"
  material="ACCENT"/>
<geom class="link" type="capsule" size=".017" fromto=".035 -.045 0 .035 .045 0"
  material="graphite"/>"""


def _elbow(name: str) -> str:
    """Forearm, roll, wrist and hand, each in the one before."""
    hand = _link(
        name, 5, f"{ROTATE_FORWARD_M} 0 0", "1 0 0", 0.260, _HAND, _fingers(name) + _tool(name)
    )
    wrist = _link(name, 4, f"{WRIST_FORWARD_M} 0 0", "0 1 0", 0.115, _WRIST, hand)
    roll = _link(name, 3, f"{ROLL_FORWARD_M} 0 0", "1 0 0", 0.415, _ROLL, wrist)
    at = f"{ELBOW_FORWARD_M} 0 {ELBOW_UP_M}"
    return _link(name, 2, at, "0 1 0", 0.322, _FOREARM, roll)


_CENTRES = ("0 0 .03", "0 0 .15", ".1 0 0", ".05 0 0", ".035 0 0", ".03 0 0")
_INERTIAS = (".001 .001 .0008", ".006 .006 .0008", ".0004 .002 .002", ".0003 .0008 .0008")


def _link(name: str, joint: int, at: str, axis: str, mass: float, looks: str, children: str) -> str:
    inertia = _INERTIAS[joint] if joint < len(_INERTIAS) else ".0001 .0002 .0002"
    return f"""
    <body name="{name}_{JOINT_NAMES[joint]}" pos="{at}" gravcomp="1">
      <inertial pos="{_CENTRES[joint]}" mass="{mass}" diaginertia="{inertia}"/>
      <joint name="{name}_{JOINT_NAMES[joint]}" axis="{axis}"
        class="{"strong" if joint < 3 else "weak"}" range="{JOINT_LOW[joint]} {JOINT_HIGH[joint]}"/>
      {looks}{children}
    </body>"""


def _fingers(name: str) -> str:
    return "".join(_finger(name, letter, side) for letter, side in (("a", 1), ("b", -1)))


def _finger(name: str, letter: str, side: int) -> str:
    pad_x = TOOL_FORWARD_M - FINGER_FORWARD_M + PAD_BELOW_M - PAD_HALF_M[0]
    size = " ".join(map(str, PAD_HALF_M))
    return f"""
    <body name="{name}_finger_{letter}" pos="{FINGER_FORWARD_M} 0 0" gravcomp="1">
      <inertial pos=".03 0 0" mass=".05" diaginertia=".00002 .00002 .00002"/>
      <joint name="{name}_finger_{letter}" type="slide" axis="0 {side} 0"
        range="0 {FINGER_TRAVEL_M}" damping="5" armature=".02"/>
      <geom class="link" type="box" size=".030 .006 .010" pos=".010 {side * 0.011} 0"
        material="metal"/>
      <geom name="{name}_pad_{letter}" class="pad" type="box" size="{size}"
        pos="{pad_x} {side * PAD_HALF_M[1]} 0" material="rubber"/>
      <geom class="look" type="box" size=".012 .0025 .0112" pos="{pad_x} {side * 0.0085} 0"
        material="ACCENT"/>
    </body>"""


def _tool(name: str) -> str:
    return f'<site name="{name}_tool" pos="{TOOL_FORWARD_M} 0 0" size=".004" group="4"/>'
