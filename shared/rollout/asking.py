"""When the high level is asked again: by interval, when its command is achieved, when it is stuck.

Source: fixed intervals as in Shi et al. 2024 (arXiv 2403.12910), a query at once after an
interjection as in Hi Robot (arXiv 2502.19417); the stuck timer is what a query by completion needs
to survive a classifier that misses the end.
"""

from typing import NamedTuple

from shared.messages.decision import Asked
from shared.messages.observation import Observation
from shared.rollout.settings import Replan, RolloutSettings


class Question(NamedTuple):
    """What the high level was asked and why.

    past: indices of the earlier decisions whose pictures it was shown besides.
    """

    observation: Observation
    past: tuple[int, ...]
    why: Asked


class Asking:
    """Why the high level is to be asked at a control step, if it is. One for an episode.

    achieved: the classifier said so of the command in force when it was last looked at.
    """

    def __init__(self, settings: RolloutSettings) -> None:
        self._settings = settings
        self._wanted: Asked | None = Asked.START
        self._asked_step = self._checked_step = 0
        self._patience_step = 0  # Since then the command is in force and not achieved.
        self.achieved = False

    def due(self, step: int) -> Asked | None:
        """Why to ask now; None: no need."""
        if self._wanted:
            return self._wanted
        patience_steps = self._settings.patience_steps
        if patience_steps and step - self._patience_step >= patience_steps:
            return Asked.STUCK
        by_interval = self._settings.replan is not Replan.COMPLETION
        return Asked.INTERVAL if by_interval and self._rested(step) else None

    def put(self, why: Asked, step: int) -> None:
        """The question was put."""
        self._wanted, self._asked_step = None, step
        if why is Asked.STUCK:
            self._patience_step = step

    def want(self, why: Asked) -> None:
        """Ask at the next control step; what opens an episode isn't outdone."""
        if self._wanted is not Asked.START:
            self._wanted = why

    def changed(self, step: int) -> None:
        """Another command is in force; that the one before was achieved is of no interest now."""
        self._patience_step, self.achieved = step, False
        if self._wanted is Asked.COMPLETION:
            self._wanted = None

    def checks(self, step: int) -> bool:
        """Whether the classifier of completion is to be looked at."""
        if self._settings.replan is Replan.INTERVAL:
            return False
        return step - self._checked_step >= self._settings.completion_check_steps

    def judge(self, completion: float, step: int) -> None:
        """What the classifier says of the command in force.

        What has just been achieved is a reason to ask at once; what stays achieved, since the high
        level repeats itself or a person's word holds, after `decision_steps`.
        """
        self._checked_step = step
        achieved = completion >= self._settings.completion_threshold
        if achieved:
            self._patience_step = step
            if not self._wanted and (not self.achieved or self._rested(step)):
                self._wanted = Asked.COMPLETION
        self.achieved = achieved

    def _rested(self, step: int) -> bool:
        return step - self._asked_step >= self._settings.decision_steps
