"""The simulated cell as a robot of the rollout: what an actor drives (`hl_dagger.robots`)."""

from typing import Any

import numpy as np

from shared.rollout.robot import Scene, Senses
from shared.workcell.env import WorkcellEnv, objects, proprioception
from shared.workcell.site import Site
from shared.workcell.studio import Studio


class Station:
    """Implements `shared.rollout.robot.Robot` on `WorkcellEnv`; the rollout counts the steps."""

    action_size = 14

    def __init__(self, site: Site | str, skills: int | None = None) -> None:
        """skills: how many each drawn wish takes; None: the task's usual number."""
        self._env = WorkcellEnv(site, max_steps=1 << 30, skills=skills)

    def reset(self, seed: int, task: str, prompt: str | None) -> Scene:
        """See `Robot.reset`.

        Raises:
            UnknownTask, UnknownPrompt: the cell doesn't know it; the message says what it knows.
        """
        options = {"task": task} if prompt is None else {"task": task, "prompt": prompt}
        _, info = self._env.reset(seed=seed, options=options)
        steps = self._env.brief.steps
        return Scene(info["task"], info["prompt"], self._env.cell.site.name, steps)

    def sense(self) -> Senses:
        state = self._env.state
        return Senses(proprioception(state), objects(state))

    def look(self) -> np.ndarray:
        return self._env.images()

    def snapshot(self) -> np.ndarray:
        return self._env.cell.snapshot()

    def photographer(self) -> Studio:
        return Studio(self._env.cell.site)

    def truth(self) -> dict[str, Any]:
        brief, disturbed = self._env.brief.to_json(), self._env.disturbed
        return {**self._env.state.to_json(), "brief": brief, "disturbed": disturbed}

    @property
    def env(self) -> WorkcellEnv:
        """The cell itself, for who judges what happens in it."""
        return self._env

    @property
    def progress(self) -> float:
        """How much of what the task asks for is in place, in [0, 1]."""
        return self._env.task.progress(self._env.state, self._env.brief)

    def right_command(self, previous: str | None) -> str:
        """What the oracle would say now, from the true state."""
        return self._env.task.next_command(self._env.state, self._env.brief, previous)

    def step(self, action: np.ndarray) -> bool:
        return self._env.advance(action)

    def close(self) -> None:
        self._env.close()
