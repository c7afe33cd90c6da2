"""Doubt: is a robot to call for help at a decision, and does a call that is open stay open? Pure.

By entropy H in nats the doubt is 1 - exp(-H), one less the inverse of the perplexity: 0 sure, 0.5
as between two goals that are equally probable, 0.75 as between four. By margin m between the best
two it is 1 - m. A robot that makes no progress has a doubt of 1.

Source: robot-gated help as in ThriftyDAgger (arXiv 2109.08273), with LazyDAgger's two thresholds
(arXiv 2104.00053), one to begin and one to end. Unlike there, the threshold is set and a budget
bounds the calls, instead of a threshold that follows from a target rate.
"""

import math
from collections.abc import Callable
from typing import Any

from services.actor.config import HelpSettings
from shared.messages.decision import Choice, Decision
from shared.messages.goal import Goal
from shared.messages.help import Help, Reason

RETURNS = 4
"""How often in turn a robot goes back to the command before, until it goes round in a circle."""


def doubt_of(decision: Decision, measure: Reason) -> float:
    """How much a decision is in doubt, 0 to 1; 0 where a person's word holds, whose it then is."""
    if decision.choice is Choice.HELD:
        return 0.0
    if measure is Reason.MARGIN:
        return 1.0 - decision.margin
    return 1.0 - math.exp(-max(0.0, decision.entropy))


class Doubt:
    """Whether a robot is in doubt, decision by decision. One for an episode.

    call: its call for help, from when it began until it is answered or taken back.
    """

    def __init__(self, settings: HelpSettings) -> None:
        self._settings = settings
        self._measure = Reason(settings.measure)
        self.call: Help | None = None
        self._command: Goal | None = None
        self._since = 0  # The step at which the command in force began, or was done, or was told.
        self._excused = False  # That it is done was an excuse once.
        self._rested_step = 0
        self._before: Goal | None = None  # The command before this one.
        self._begun = 0
        self._returns = 0
        self._circle_begun = 0  # When the first of two commands in turn began.

    def look(
        self, decision: Decision, achieved: Callable[[], bool], may_call: Callable[[], bool]
    ) -> Help | None:
        """The call that is open after this decision; None: the robot goes on confidently.

        achieved: whether the command in force is done; asked only where its time is up.
        may_call: whether the budget has a call left, which it spends; asked only where there is a
            reason to call.
        """
        same = decision.executed == self._command
        if not same:
            self._change(decision.executed, decision.step)
        doubt = doubt_of(decision, self._measure)
        if self.call:
            if self._lasts(doubt, same):
                return self._tell(doubt=1.0 if self.call.reason is Reason.STUCK else doubt)
            self.close(decision.step)
        reason = self._reason(decision, doubt, achieved)
        if reason is None or decision.step < self._rested_step or not may_call():
            return None
        self.call = Help(
            decision=decision.id,
            step=decision.step,
            time_ns=decision.time_ns,
            reason=reason,
            doubt=1.0 if reason is Reason.STUCK else doubt,
        )
        return self.call

    def close(self, step: int) -> None:
        """The call is answered or taken back; the next one comes after a pause at the soonest."""
        self.call = None
        self._rested_step = step + self._settings.pause_steps
        self._since = step
        self._returns, self._circle_begun = 0, step

    def _change(self, command: Goal, step: int) -> None:
        if command == self._before:
            self._returns += 1
        else:
            self._returns, self._circle_begun = 0, self._begun
        self._before, self._command = self._command, command
        self._begun, self._since, self._excused = step, step, False

    def _reason(
        self, decision: Decision, doubt: float, achieved: Callable[[], bool]
    ) -> Reason | None:
        if self._stuck(decision.step, achieved):
            return Reason.STUCK
        threshold = self._settings.threshold
        return self._measure if threshold is not None and doubt >= threshold else None

    def _lasts(self, doubt: float, same: bool) -> bool:
        """Whether the reason of the open call is one still."""
        assert self.call is not None
        if self.call.reason is Reason.STUCK:
            return same or self._circles()
        return doubt >= self._settings.calm * (self._settings.threshold or 0.0)

    def _stuck(self, step: int, achieved: Callable[[], bool]) -> bool:
        """One command for long, and nothing comes of it; or two in turn, again and again.

        That it is done excuses it once, as the high level may need a moment to see it; who still
        wants the same thing after as long again is stuck, too.
        """
        patience_steps = self._settings.stuck_steps
        if not patience_steps:
            return False
        if self._circles() and step - self._circle_begun >= patience_steps:
            return True
        if step - self._since < patience_steps:
            return False
        if not self._excused and achieved():
            self._since, self._excused = step, True
            return False
        return True

    def _circles(self) -> bool:
        """Back and forth between two commands, done or not, since nothing new comes of it."""
        return self._returns >= RETURNS

    def _tell(self, **changes: Any) -> Help:
        assert self.call is not None
        self.call = self.call.model_copy(update=changes)
        return self.call
