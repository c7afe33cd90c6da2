"""Pictures for people, drawn beside the physics: in a thread of its own, from a snapshot."""

import numpy as np

from shared.workcell.camera import STYLES, Eye  # first: it chooses the GL platform

import mujoco  # isort: skip

from shared.workcell.scene import scene_xml
from shared.workcell.site import Site


class Studio:
    """Has a model of its own, so that drawing never waits for the physics, nor the other way round.

    All calls, the constructor's too, come from one thread, which owns the GL contexts.
    """

    def __init__(self, site: Site) -> None:
        self._model = mujoco.MjModel.from_xml_string(scene_xml(site))
        self._data = mujoco.MjData(self._model)
        self._eyes: dict[tuple[int, int], Eye] = {}

    def picture(self, snapshot: np.ndarray, camera: str, width: int, height: int) -> np.ndarray:
        """What `camera` sees at a `snapshot` of the cell, [height, width, 3] uint8."""
        joints = self._model.nq
        self._data.qpos[:] = snapshot[:joints]
        self._data.mocap_pos[:] = snapshot[joints:].reshape(-1, 3)
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_camlight(self._model, self._data)
        size = (width, height)
        if size not in self._eyes:
            self._eyes[size] = Eye(self._model, width, height, STYLES["live"])
        return self._eyes[size].look(self._data, camera)

    def close(self) -> None:
        """Free the GL contexts."""
        for eye in self._eyes.values():
            eye.close()
        self._eyes.clear()
