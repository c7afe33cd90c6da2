"""The cell as physics: reset, step, the true state, pictures. Knows no task and no reward."""

import logging

import numpy as np

from shared.workcell import layout
from shared.workcell.camera import STYLES, Eye

import mujoco  # isort: skip  # after camera, which chooses the GL platform

from shared.workcell.errors import InvalidAction
from shared.workcell.expert import HOME
from shared.workcell.kinematics import (
    ARM_NAMES,
    GRIP_CLOSED_M,
    GRIP_OPEN_M,
    JOINT_HIGH,
    JOINT_LOW,
    JOINT_NAMES,
    inverse,
)
from shared.workcell.objects import (
    BODY_NAMES,
    COUNT,
    FIXTURE_NAMES,
    KITCHEN,
    OBJECT_NAMES,
    Stock,
    absent_at,
)
from shared.workcell.scene import SUBSTEPS, scene_xml
from shared.workcell.site import Site, load_site
from shared.workcell.state import CellState, near_plate

_log = logging.getLogger(__name__)

CONTROL_HZ = 50
SETTLE_STEPS = 12
ACTION_LOW = np.array([*JOINT_LOW, GRIP_CLOSED_M] * 2)
ACTION_HIGH = np.array([*JOINT_HIGH, GRIP_OPEN_M] * 2)
_DIVERGED = (
    mujoco.mjtWarning.mjWARN_BADQPOS,
    mujoco.mjtWarning.mjWARN_BADQVEL,
    mujoco.mjtWarning.mjWARN_BADQACC,
)
for _bounds in (ACTION_LOW, ACTION_HIGH):
    _bounds.setflags(write=False)


def _hear(text: str) -> None:
    """MuJoCo's warnings go where others go, instead of into a file beside the caller."""
    _log.warning("mujoco: %s", text)


mujoco.set_mju_user_warning(_hear)


class Cell:
    """Two arms and a table with the things of a stock; 14 joint targets a step at 50 Hz.

    Equal seeds and actions give equal states to the bit, in one process and across processes.
    diverged: how often the physics gave numbers that can't be, which is taken back.
    """

    def __init__(self, site: Site | str = "lab") -> None:
        self.site = load_site(site) if isinstance(site, str) else site
        self._model = mujoco.MjModel.from_xml_string(scene_xml(self.site))
        self._data = mujoco.MjData(self._model)
        self._index()
        self._rng = np.random.default_rng(0)
        self._slipping = [0, 0]
        self._eyes: dict[tuple[int, int, str], Eye] = {}
        self._state: CellState | None = None  # None: it must be read anew.
        self.diverged = 0
        self.reset(self._rng)

    def _index(self) -> None:
        """Look up once where the names lie in MuJoCo's arrays."""
        model = self._model
        joints = [
            f"{arm}_{joint}"
            for arm in ARM_NAMES
            for joint in (*JOINT_NAMES, "finger_a", "finger_b")
        ]
        rows = np.array([model.joint(name).qposadr[0] for name in joints]).reshape(2, 8)
        self._joint_rows, self._finger_rows = rows[:, :6], rows[:, 6:]
        self._object_rows = [int(model.joint(name).qposadr[0]) for name in OBJECT_NAMES]
        self._velocity_rows = [int(model.joint(name).dofadr[0]) for name in OBJECT_NAMES]
        self._bodies = [model.body(name).id for name in BODY_NAMES]
        self._mocaps = {name: int(model.body(name).mocapid[0]) for name in FIXTURE_NAMES}
        self._fixed = {name: model.body(name).pos.copy() for name in FIXTURE_NAMES}
        self._sites = [model.site(f"{arm}_tool").id for arm in ARM_NAMES]
        self._pad_of_geom = np.full(model.ngeom, -1)
        self._object_of_geom = np.full(model.ngeom, -1)
        pads = [f"{arm}_pad_{letter}" for arm in ARM_NAMES for letter in "ab"]
        for row, name in enumerate(pads):
            self._pad_of_geom[model.geom(name).id] = row
        for row, name in enumerate(OBJECT_NAMES):
            self._object_of_geom[model.geom(name).id] = row

    def reset(self, rng: np.random.Generator, stock: Stock = KITCHEN) -> None:
        """Arms home, the things of a stock scattered anew and at rest, all others away.

        The cell keeps `rng` for the slips.
        """
        self._rng, self._slipping = rng, [0, 0]
        mujoco.mj_resetData(self._model, self._data)
        home = np.concatenate([[*inverse(arm, *HOME[arm]), GRIP_OPEN_M] for arm in (0, 1)])
        self._data.qpos[self._joint_rows] = home.reshape(2, 7)[:, :6]
        self._data.qpos[self._finger_rows] = GRIP_OPEN_M / 2
        for row, name in enumerate(FIXTURE_NAMES, COUNT):
            there = self._fixed[name] if name in stock else absent_at(row)
            self._data.mocap_pos[self._mocaps[name]] = there
        starts = layout.starts(rng, stock)
        for item in range(COUNT):
            if item in starts:
                x, y, z, yaw = starts[item]
                self._set_pose(item, (x, y, z), yaw)
            else:
                self._set_pose(item, absent_at(item), 0.0)
            # What hovers far away is weightless and touches nothing: it costs next to nothing.
            self._model.body_gravcomp[self._bodies[item]] = float(item not in starts)
        self._advance(home, SETTLE_STEPS)

    def place(self, name: str, position: tuple[float, float, float], yaw: float = 0.0) -> None:
        """Put an object of the stock somewhere, at rest: by a person, or to arrange a scene."""
        self._set_pose(OBJECT_NAMES.index(name), position, yaw)
        self._forward()

    def move_plate(self, x: float, y: float) -> None:
        """Push the plate to (x, y) [m], with all that lies on it."""
        mocap = self._mocaps["plate"]
        shift = np.array([x, y]) - self._data.mocap_pos[mocap, :2]
        for item in near_plate(self.state()):
            row = self._object_rows[item]
            self._data.qpos[row : row + 2] += shift
        self._data.mocap_pos[mocap, :2] += shift
        self._forward()

    def step(self, targets: np.ndarray) -> None:
        """Advance one control step towards 14 joint targets; beyond the limits they are clipped.

        Raises:
            InvalidAction: not 14 finite numbers.
        """
        targets = np.asarray(targets, dtype=np.float64)
        if targets.shape != (14,) or not np.isfinite(targets).all():
            raise InvalidAction(f"an action is 14 finite joint targets; got {targets!r}")
        targets = np.clip(targets, ACTION_LOW, ACTION_HIGH)
        if self.site.slip_rate > 0:
            self._slip(targets)
        self._advance(targets, 1)

    def state(self) -> CellState:
        """The true state now."""
        if self._state is None:
            self._state = self._read()
        return self._state

    def _read(self) -> CellState:
        data = self._data
        joints = np.empty((2, 7))
        joints[:, :6] = data.qpos[self._joint_rows]
        joints[:, 6] = data.qpos[self._finger_rows].sum(axis=1)
        turns = data.site_xmat[self._sites]  # (2, 9)
        yaws = np.arctan2(turns[:, 4], turns[:, 1])
        return CellState(
            joints=joints.ravel(),
            tools=np.column_stack([data.site_xpos[self._sites], yaws]),
            positions=data.xpos[self._bodies],
            quaternions=data.xquat[self._bodies],
            held=self._held(),
        )

    def snapshot(self) -> np.ndarray:
        """Joint positions (qpos), then where the fixtures are: what a `Studio` draws from."""
        return np.concatenate([self._data.qpos, self._data.mocap_pos.ravel()])

    def render(self, camera: str, height: int, width: int, style: str = "policy") -> np.ndarray:
        """A picture from camera top or angle, [height, width, 3] uint8, in a style of `STYLES`."""
        key = (width, height, style)
        if key not in self._eyes:
            self._eyes[key] = Eye(self._model, width, height, STYLES[style])
        return self._eyes[key].look(self._data, camera)

    def close(self) -> None:
        """Free the GL contexts; the physics stays usable."""
        for eye in self._eyes.values():
            eye.close()
        self._eyes.clear()

    def _set_pose(self, item: int, position: tuple[float, float, float], yaw: float) -> None:
        row, speed = self._object_rows[item], self._velocity_rows[item]
        quaternion = (np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2))
        self._data.qpos[row : row + 7] = (*position, *quaternion)
        self._data.qvel[speed : speed + 6] = 0.0

    def _forward(self) -> None:
        """Bring what follows from the poses up to date, after something was moved by hand."""
        self._state = None
        mujoco.mj_forward(self._model, self._data)

    def _advance(self, targets: np.ndarray, steps: int) -> None:
        self._state = None
        self._data.ctrl[:] = targets
        self._data.ctrl[[6, 13]] = targets[[6, 13]] / 2  # the gap is twice a finger's way
        before = self._data.qpos.copy(), self._data.mocap_pos.copy()
        mujoco.mj_step(self._model, self._data, steps * SUBSTEPS)
        if any(self._data.warning[kind].number for kind in _DIVERGED):
            self._take_back(*before)
        mujoco.mj_kinematics(self._model, self._data)

    def _take_back(self, positions: np.ndarray, fixtures: np.ndarray) -> None:
        """Undo a step that diverged: all is where it was, at rest.

        MuJoCo by itself goes back to the pose of its model, in the midst of an episode.
        """
        mujoco.mj_resetData(self._model, self._data)
        self._data.qpos[:], self._data.mocap_pos[:] = positions, fixtures
        self.diverged += 1
        _log.warning("the physics diverged: all is held where it was a step ago")

    def _slip(self, targets: np.ndarray) -> None:
        """Now and then open a hand that holds something, for `slip_steps` steps."""
        held = self.state().held
        for arm in (0, 1):
            if held[arm] >= 0 and self._rng.random() < self.site.slip_rate:
                self._slipping[arm] = self.site.slip_steps
            if self._slipping[arm] > 0:
                self._slipping[arm] -= 1
                targets[7 * arm + 6] = GRIP_OPEN_M

    def _held(self) -> np.ndarray:
        """[2] the object that touches both pads of each arm, the nearest to the tool; -1: none."""
        geoms = self._data.contact.geom  # (contacts, 2)
        touched = np.zeros((4, COUNT), dtype=bool)
        if len(geoms):
            pads = self._pad_of_geom[geoms].max(axis=1)
            items = self._object_of_geom[geoms].max(axis=1)
            both = (pads >= 0) & (items >= 0)
            touched[pads[both], items[both]] = True
        held = np.full(2, -1)
        for arm in (0, 1):
            squeezed = np.flatnonzero(touched[2 * arm] & touched[2 * arm + 1])
            if len(squeezed):
                held[arm] = self._nearest(arm, squeezed)
        return held

    def _nearest(self, arm: int, items: np.ndarray) -> int:
        tool = self._data.site_xpos[self._sites[arm]]
        places = self._data.xpos[[self._bodies[item] for item in items]]
        return int(items[np.argmin(np.linalg.norm(places - tool, axis=1))])
