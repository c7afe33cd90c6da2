"""The low level alone: it obeys a command until another one is said, as in the rollout."""

import numpy as np

from shared.messages.goal import Goal
from shared.rollout.robot import LowLevel
from shared.rollout.settings import RolloutSettings
from shared.workcell.env import WorkcellEnv, objects, proprioception

EXECUTE_STEPS = RolloutSettings().execute_steps


class Hand:
    """The low level with its running chunk."""

    def __init__(self, low_level: LowLevel) -> None:
        self._low_level = low_level
        self._said = ""
        self._chunk: list[np.ndarray] = []

    def obey(self, command: str) -> None:
        """Another command cuts the chunk."""
        if command != self._said:
            self._said, self._chunk = command, []

    def move(self, env: WorkcellEnv) -> np.ndarray:
        """The next action, [14]."""
        if not self._chunk:
            senses = proprioception(env.state), objects(env.state)
            chunk = self._low_level.act(*senses, Goal(text=self._said))
            self._chunk = list(chunk[:EXECUTE_STEPS])
        return self._chunk.pop(0)
