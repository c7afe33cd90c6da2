"""The cell as a gymnasium environment: what the actor steps and the training draws from."""

from typing import Any, cast

import gymnasium
import numpy as np
from gymnasium import spaces

from shared.workcell.camera import CAMERA_NAMES
from shared.workcell.cell import ACTION_HIGH, ACTION_LOW, CONTROL_HZ, Cell
from shared.workcell.errors import UnknownPrompt
from shared.workcell.objects import BODY_NAMES
from shared.workcell.people import Passers
from shared.workcell.site import Site
from shared.workcell.state import CellState
from shared.workcell.tasks import TASKS, Brief, Draw, Task, task_named, understand

IMAGE_SIZE = 64
HELD_SUCCESS_STEPS = 10
ATTEMPTS = 20
"""Draws of a table until something on it fits the wish."""
FAR = 10.0
"""Bound of every number in an observation, in metres or radians; nothing gets so far."""

Observation = dict[str, np.ndarray]
Info = dict[str, Any]


class WorkcellEnv(gymnasium.Env[Observation, np.ndarray]):
    """One attempt at one task in the cell, 50 steps a second.

    Action: [14] joint targets in rad, of each arm (left first) waist, shoulder, elbow, forearm
    roll, wrist angle, wrist rotate, and the gap between its pads in m.
    Observation: `proprioception` [22], the 14 measured joints, then of each tool x y z [m] and
    yaw [rad]; `objects` [18, 9], of each thing its position and the first two columns of its
    rotation, zeros where it isn't in the cell; with `cameras` also `top` and `angle`,
    [64, 64, 3] uint8.
    Ends when the task has been fulfilled for 10 steps on end with empty hands; is cut off after
    `max_steps` (None: as many as the wish deserves). `skills` sets how many each wish takes.
    Everything random is drawn from the seed that `reset` gets.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": CONTROL_HZ}

    def __init__(
        self,
        site: Site | str = "lab",
        cameras: bool = False,
        max_steps: int | None = None,
        render_mode: str | None = None,
        skills: int | None = None,
    ) -> None:
        self.cell = Cell(site)
        self.cameras, self.max_steps, self.render_mode = cameras, max_steps, render_mode
        prompts = self.cell.site.prompts
        self.draw = Draw(skills, prompts.manner, prompts.constraints)
        low, high = ACTION_LOW.astype(np.float32), ACTION_HIGH.astype(np.float32)
        self.action_space = spaces.Box(low, high, dtype=np.float32)
        self.observation_space = _space(cameras)
        self.brief: Brief = next(iter(TASKS.values())).sample(np.random.default_rng(0))
        self.state: CellState = self.cell.state()
        self.elapsed_steps = 0
        self._fulfilled_steps = 0
        self._people = Passers(self.cell, np.random.default_rng(0))

    @property
    def disturbed(self) -> int:
        """How often people did something at the table in this episode."""
        return self._people.count

    @property
    def task(self) -> Task:
        """The task of this episode."""
        return task_named(self.brief.task)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, Info]:
        """Scatter the objects and take up a wish.

        options: `prompt`, a sentence to obey, or `task`, a task's name to draw a wish from;
        without either both task and wish are drawn.
        Raises:
            UnknownPrompt, UnknownTask: the options ask for what the cell does not know.
            InvalidLength: the task can't take so many skills.
        """
        super().reset(seed=seed)
        for _ in range(ATTEMPTS):
            brief = self._wish(**(options or {}))
            self.cell.reset(self.np_random, brief.stock)
            self.state = self.cell.state()
            self.brief = brief.settle(self.state)
            if self.brief.target:
                break
        else:
            raise UnknownPrompt(
                f"{brief.prompt!r}: nothing on the table fits, at any of its places"
            )
        self.elapsed_steps = self._fulfilled_steps = 0
        self._people = Passers(self.cell, self.np_random.spawn(1)[0])
        return self._observe(), self._info()

    def step(self, action: np.ndarray) -> tuple[Observation, float, bool, bool, Info]:
        """One control step. The reward is the progress in [0, 1], 1 meaning fulfilled."""
        terminated = self.advance(action)
        truncated = not terminated and self.elapsed_steps >= (self.max_steps or self.brief.steps)
        reward = self.task.progress(self.state, self.brief)
        return self._observe(), reward, terminated, truncated, self._info()

    def advance(self, action: np.ndarray) -> bool:
        """One control step, for who looks at `state` only when it needs to; whether it is done."""
        self.cell.step(action)
        self.state = self.cell.state()
        seen = self._people.count
        self._people.pass_by(self.state, self.brief.target)
        if self._people.count > seen:
            self.state = self.cell.state()
        self.elapsed_steps += 1
        done = not self.state.holding and self.task.success(self.state, self.brief)
        self._fulfilled_steps = self._fulfilled_steps + 1 if done else 0
        return self._fulfilled_steps >= HELD_SUCCESS_STEPS

    def images(self, size: int = IMAGE_SIZE) -> np.ndarray:
        """What a policy sees now: top and angle, [2, size, size, 3] uint8."""
        return np.stack([self.cell.render(camera, size, size) for camera in CAMERA_NAMES])

    def picture(
        self, camera: str = "angle", width: int = 960, height: int = 720, style: str = "live"
    ) -> np.ndarray:
        """A picture for people, [height, width, 3] uint8: live, or a portrait with shadows."""
        return self.cell.render(camera, height, width, style)

    def render(self) -> np.ndarray | None:
        """The presentation picture, in render mode rgb_array."""
        return self.picture() if self.render_mode == "rgb_array" else None

    def close(self) -> None:
        """Free the GL contexts."""
        self.cell.close()

    def _wish(self, task: str | None = None, prompt: str | None = None) -> Brief:
        if prompt is not None:
            return understand(prompt) if task is None else task_named(task).understand(prompt)
        if task is None:
            names = [name for name, known in TASKS.items() if self._can_take(known)]
            task = names[int(self.np_random.integers(len(names)))]
        return task_named(task).sample(self.np_random, self.draw)

    def _can_take(self, task: Task) -> bool:
        return self.draw.skills is None or self.draw.skills in task.lengths

    def _observe(self) -> Observation:
        seen = {"proprioception": proprioception(self.state), "objects": objects(self.state)}
        if self.cameras:
            seen |= dict(zip(CAMERA_NAMES, self.images(), strict=True))
        return seen

    def _info(self) -> Info:
        return {
            "prompt": self.brief.prompt,
            "task": self.brief.task,
            "success": self.task.success(self.state, self.brief),
            "elapsed_steps": self.elapsed_steps,
            "disturbed": self.disturbed,
        }


def proprioception(state: CellState) -> np.ndarray:
    """[22] float32: the joints, then x y z yaw of each tool."""
    return np.concatenate([state.joints, state.tools.ravel()]).astype(np.float32)


def objects(state: CellState) -> np.ndarray:
    """[18, 9] float32: position, then the first two columns of the rotation; 0 if not there."""
    w, x, y, z = state.quaternions.T
    first = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)], axis=1)
    second = np.stack([2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)], axis=1)
    rows = np.concatenate([state.positions, first, second], axis=1).astype(np.float32)
    rows[~state.present] = 0.0
    return rows


def _space(cameras: bool) -> spaces.Space[Observation]:
    parts: dict[str, spaces.Space[Any]] = {
        "proprioception": spaces.Box(-FAR, FAR, (22,), np.float32),
        "objects": spaces.Box(-FAR, FAR, (len(BODY_NAMES), 9), np.float32),
    }
    if cameras:
        picture = spaces.Box(0, 255, (IMAGE_SIZE, IMAGE_SIZE, 3), np.uint8)
        parts |= {name: picture for name in CAMERA_NAMES}
    return cast("spaces.Space[Observation]", spaces.Dict(parts))
