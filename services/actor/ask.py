"""Ask: a robot in doubt calls for help, stands still for a while if it shall, and then carries on.

Who waits does so as in supervised lockstep, by `Rollout.awaited`, but never for longer than it may.
"""

from collections.abc import Callable

import structlog

from services.actor.config import HelpSettings
from services.actor.doubt import Doubt
from services.actor.logbook import Logbook
from shared.budget import Budget
from shared.clock import Clock
from shared.messages.correction import Correction
from shared.messages.decision import Decision
from shared.messages.help import Help
from shared.messages.receipt import Receipt
from shared.rollout.rollout import Rollout

log = structlog.get_logger()


class Asker:
    """The calls for help of one robot, over all of its episodes.

    expired: how often nobody came in the time that it stood still, since this process began.
    """

    def __init__(self, robot: str, settings: HelpSettings, logbook: Logbook, clock: Clock) -> None:
        self._robot, self._settings, self._logbook, self._clock = robot, settings, logbook, clock
        self._budget = Budget(settings.per_hour, logbook.called_ns)
        self._told: tuple[str, bool] | None = None
        self.expired = 0
        self.begin()

    def begin(self) -> None:
        """Another episode; what the one before was in doubt about is over."""
        self._doubt = Doubt(self._settings)
        self._until_ns: int | None = None

    @property
    def waiting(self) -> bool:
        """The robot stands still until somebody answers."""
        return self._until_ns is not None

    @property
    def call(self) -> Help | None:
        """The call that is open, with what is left now of the time that the robot waits."""
        call = self._doubt.call
        if call is None or self._until_ns is None:
            return call
        left_ns = max(0, self._until_ns - self._clock.monotonic_ns())
        return call.model_copy(update={"waits_s": left_ns / 1e9})

    def news(self) -> bool:
        """Whether a call began, ended, or is no longer waited for since this was asked last."""
        call = self._doubt.call
        told = (call.decision, self.waiting) if call else None
        changed, self._told = told != self._told, told
        return changed

    def look(self, rollout: Rollout, decision: Decision, achieved: Callable[[], bool]) -> Decision:
        """The decision as it is to be told: with the call that is open.

        achieved: whether the command in force is done; asked only where its time is up.
        """
        self._doubt.look(decision, achieved, self._may_call)
        begun = self._doubt.call is not None and self._doubt.call.decision == decision.id
        if begun and self._settings.wait_s and not decision.awaits_verdict:
            self._until_ns = self._clock.monotonic_ns() + int(self._settings.wait_s * 1e9)
        elif self._doubt.call is None:
            self._until_ns = None
        if call := self.call:
            decision = decision.model_copy(update={"help": call})
        if self.waiting or rollout.awaited:
            rollout.awaited = decision
        if begun and call:
            log.info("asks for help", robot=self._robot, why=call.reason, doubt=call.doubt)
        return decision

    def hear(self, rollout: Rollout, correction: Correction, receipt: Receipt) -> None:
        """Somebody spoke about this robot: that answers its call, whatever it was about."""
        if self._doubt.call and receipt.accepted and correction.kind.answers:
            self._doubt.close(rollout.step)
            self._go_on(rollout)

    def mind(self, rollout: Rollout) -> None:
        """When the time is up: carry on; the call stays open, and may be answered later."""
        if self._until_ns is not None and self._clock.monotonic_ns() >= self._until_ns:
            self.expired += 1
            log.info("nobody came, carrying on", robot=self._robot, times=self.expired)
            self._go_on(rollout)

    def _go_on(self, rollout: Rollout) -> None:
        if self._until_ns is not None:
            self._until_ns = None
            rollout.awaited = None

    def _may_call(self) -> bool:
        """Spends from the budget, and remembers that over a restart."""
        spent = self._budget.spend(self._clock.now_ns())
        if spent:
            self._logbook.called(self._budget.spent_ns)
        return spent
