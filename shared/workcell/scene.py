"""The cell's MuJoCo model, built from code for one site: primitives only, no mesh files.

Collision masks: 1 furniture, 2 objects, 4 arms. Arms touch furniture and objects, not each
other: the expert does not plan around the other arm.
"""

import numpy as np

from shared.workcell import clutter, food, layout, wares
from shared.workcell.objects import OBJECTS, Object
from shared.workcell.robot import actuators_xml, arm_xml, coupling_xml
from shared.workcell.shapes import shaded
from shared.workcell.site import CameraShift, Colour, Offset, Site

TIMESTEP_S = 0.004
SUBSTEPS = 5
"""Physics steps in one control step: 50 Hz."""

_TOP = ((0.0, 0.018, 0.85), (0.0, 0.020, 0.0))
_ANGLE = ((0.0, -0.62, 0.50), (0.0, 0.025, 0.02))
FOVY_DEGREES = 42


def scene_xml(site: Site) -> str:
    """The whole model as MJCF text."""
    return f"""
<mujoco model="workcell">
  <compiler angle="radian" autolimits="true"/>
  <option timestep="{TIMESTEP_S}" integrator="implicitfast" cone="elliptic" impratio="10"
    noslip_iterations="0" iterations="20" tolerance="1e-6" solver="Newton">
    <flag multiccd="enable"/>
  </option>
  <visual>
    <global offwidth="1920" offheight="1080"/>
    <headlight ambient="{_scaled(site.light.tint, site.light.ambient)}"
      diffuse="{_scaled(site.light.tint, 0.18)}" specular="0 0 0"/>
    <map znear="0.02" zfar="12" shadowclip="0.9" shadowscale="0.7"/>
  </visual>
  <statistic center="0 0 0.1" extent="1"/>
  {_defaults()}
  {_assets(site)}
  <worldbody>
    {_lights(site)}
    {_cameras(site)}
    {_furniture()}
    {clutter.clutter_xml(site.distractors)}
    {arm_xml(0)}
    {arm_xml(1)}
    {"".join(_object(item, site) for item in OBJECTS)}
  </worldbody>
  <equality>{coupling_xml(0)}{coupling_xml(1)}</equality>
  <actuator>{actuators_xml(0)}{actuators_xml(1)}</actuator>
</mujoco>"""


def _defaults() -> str:
    contact = 'condim="4" solref=".008 1" solimp=".95 .99 .001"'
    return f"""
  <default>
    <geom friction=".7 .01 .0005"/>
    <default class="look"><geom contype="0" conaffinity="0" group="2"/></default>
    <default class="food">
      <geom contype="0" conaffinity="0" group="2" mass="0"/>
      <default class="detail"><geom group="1"/></default>
    </default>
    <default class="object">
      <geom contype="2" conaffinity="7" group="3" {contact} friction=".7 .01 .0005"/>
    </default>
    <default class="furniture"><geom contype="1" conaffinity="6" condim="3" group="2"/></default>
    <default class="arm">
      <default class="strong"><joint damping="2" armature=".1" frictionloss=".2"/></default>
      <default class="weak"><joint damping=".5" armature=".03" frictionloss=".1"/></default>
      <default class="link"><geom contype="4" conaffinity="3" condim="3" group="2"/></default>
      <default class="pad">
        <geom contype="4" conaffinity="3" group="2" priority="1" {contact}
          friction="1 .02 .0005"/>
      </default>
    </default>
  </default>"""


def _assets(site: Site) -> str:
    shades = site.shades
    plain = "".join(
        f'<material name="{name}" rgba="{_rgba(colour)}" specular="{gloss}" shininess=".4"/>'
        for name, colour, gloss in (
            ("tray", shades.tray, 0.05),
            ("plate", shades.plate, 0.3),
            ("bin", shades.bin, 0.2),
            ("tub", shades.tub, 0.2),
            ("graphite", (0.17, 0.18, 0.20), 0.35),
            ("metal", (0.40, 0.42, 0.45), 0.5),
            ("rubber", (0.10, 0.10, 0.11), 0.05),
            ("left", (0.10, 0.62, 0.60), 0.3),
            ("right", (0.95, 0.50, 0.13), 0.3),
        )
    )
    darker = _rgb(_times(shades.wall, 0.55))
    return f"""
  <asset>
    <texture name="sky" type="skybox" builtin="gradient" rgb1="{_rgb(shades.wall)}"
      rgb2="{darker}" width="256" height="256"/>
    <texture name="wood" type="2d" builtin="flat" rgb1="{_rgb(shades.table)}" mark="random"
      markrgb="{_rgb(_times(shades.table, 0.86))}" random=".25" width="64" height="512"/>
    <material name="wood" texture="wood" texrepeat="6 2" specular=".1" shininess=".2"/>
    <material name="floor" rgba="{_rgba(_times(shades.wall, 0.7))}" specular="0"/>
    {plain}
  </asset>"""


def _lights(site: Site) -> str:
    x, y, z = site.light.direction
    lamp = _scaled(site.light.tint, site.light.level)
    return f"""
    <light name="lamp" pos="{-x * 1.5} {-y * 1.5} {-z * 1.5}" dir="{x} {y} {z}"
      type="directional" castshadow="true" diffuse="{lamp}" specular=".25 .25 .25"/>
    <light name="fill" pos="0 -1 1.2" dir="{-x} 0.6 -0.6" type="directional" castshadow="false"
      diffuse="{_scaled(site.light.tint, site.light.level * 0.3)}" specular="0 0 0"/>"""


def _cameras(site: Site) -> str:
    top = _camera("top", *_TOP, site.top, upward=(0.0, 1.0, 0.0))
    return top + _camera("angle", *_ANGLE, site.angle, upward=(0.0, 0.0, 1.0))


def _camera(name: str, place: Offset, aim: Offset, shift: CameraShift, upward: Offset) -> str:
    """A camera at `place` that looks at `aim`, both shifted as the site says, and stands level."""
    at = np.add(place, shift.position_m)
    back = at - np.add(aim, shift.aim_m)
    right = np.cross(upward, back)
    axes = " ".join(f"{part:.6f}" for part in (*right, *np.cross(back, right)))
    return (
        f'<camera name="{name}" pos="{at[0]} {at[1]} {at[2]}" xyaxes="{axes}" '
        f'fovy="{FOVY_DEGREES}"/>'
    )


def _furniture() -> str:
    """Floor, table, tray with its rim, plate and bin."""
    tray, rim = layout.TRAY, layout.RIM_M
    plate_x, plate_y = layout.PLATE_XY
    radius, top = layout.PLATE_RADIUS_M, layout.PLATE_TOP_M
    return f"""
    <geom class="look" type="plane" size="4 4 .1" pos="0 0 -.75" material="floor"/>
    <geom class="furniture" type="plane" size="1 1 .1" group="3"/>
    <geom class="look" type="box" size=".65 .45 .02" pos="0 0 -.0201" material="wood"/>
    <geom class="look" type="box" size="{tray.half_x_m} {tray.half_y_m} .0005"
      pos="{tray.x_m} {tray.y_m} 0" material="tray"/>
    {_walls(tray, rim, layout.RIM_TOP_M, "wood")}
    <body name="plate" mocap="true" pos="{plate_x} {plate_y} 0">
      <geom class="furniture" type="cylinder" size="{radius} .02" pos="0 0 {top - 0.02}"
        material="plate"/>
      <geom class="look" type="cylinder" size="{radius * 0.74} .0003" pos="0 0 {top}"
        rgba=".80 .80 .78 1"/>
      <geom class="look" type="cylinder" size="{radius * 0.71} .0004" pos="0 0 {top}"
        material="plate"/>
    </body>
    {_container("bin", layout.BIN)}
    {_container("tub", layout.TUB)}"""


def _container(name: str, box: layout.Box) -> str:
    """A shallow open box; it stands still, but a table may be without it."""
    wall, floor = layout.BIN_WALL_M, layout.BIN_FLOOR_M
    return f"""
    <body name="{name}" mocap="true" pos="{box.x_m} {box.y_m} 0">
      <geom class="furniture" type="box" size="{box.half_x_m} {box.half_y_m} .02"
        pos="0 0 {floor - 0.02}" material="{name}"/>
      {_walls(layout.Box(0.0, 0.0, box.half_x_m, box.half_y_m), wall, layout.BIN_TOP_M, name)}
    </body>"""


def _walls(box: layout.Box, half: float, height: float, material: str) -> str:
    """Four walls around a rectangle, with round posts at the corners."""
    walls = ""
    for side in (-1, 1):
        for size, x, y in (
            (f"{half} {box.half_y_m}", side * box.half_x_m, 0.0),
            (f"{box.half_x_m} {half}", 0.0, side * box.half_y_m),
        ):
            walls += (
                f'<geom class="furniture" type="box" size="{size} {height / 2}" '
                f'pos="{box.x_m + x} {box.y_m + y} {height / 2}" material="{material}"/>'
            )
        for other in (-1, 1):
            x, y = box.x_m + side * box.half_x_m, box.y_m + other * box.half_y_m
            walls += (
                f'<geom class="look" type="cylinder" size="{half * 1.2} {height / 2 + 0.0003}" '
                f'pos="{x} {y} {height / 2}" material="{material}"/>'
            )
    return walls


def _object(item: Object, site: Site) -> str:
    kind = food if item.kind == "food" else wares
    colours = [shaded(colour, item.name, site.shades) for colour in kind.COLOURS[item.name]]
    width, length, height = item.half_sizes_m
    form, size = (
        ("cylinder", f"{width} {height}")
        if item.shape == "disc"
        else ("box", f"{width} {length} {height}")
    )
    return f"""
    <body name="{item.name}" pos="0 0 .5">
      <freejoint name="{item.name}"/>
      <geom name="{item.name}" class="object" type="{form}" size="{size}"
        mass="{item.mass_kg}"/>
      {kind.LOOKS[item.name](item, colours)}
    </body>"""


def _times(colour: Colour, factor: float) -> Colour:
    red, green, blue = (min(1.0, part * factor) for part in colour)
    return red, green, blue


def _scaled(colour: Colour, factor: float) -> str:
    return _rgb(_times(colour, factor))


def _rgb(colour: Colour) -> str:
    return " ".join(f"{part:.4f}" for part in colour)


def _rgba(colour: Colour) -> str:
    return _rgb(colour) + " 1"
