"""Calls: which robots ask for help, the most urgent first, and no more than people have time for.

Bus threads and the event loop write, everybody reads; one lock, held for moments only.
"""

import threading
from collections.abc import Callable
from dataclasses import dataclass, replace

from services.correction_api.metrics import Metrics
from shared.budget import Budget
from shared.clock import Clock
from shared.messages.correction import Correction
from shared.messages.help import Help
from shared.messages.receipt import Receipt


@dataclass(frozen=True)
class Call:
    """A robot's last call for help.

    help: as it was told last. time_ns: when, by the actor's clock; heard_ns: by the one here.
    shown: within the budget of the fleet. answered: by a correction that took force.
    open: neither answered nor taken back.
    """

    robot: str
    help: Help
    time_ns: int
    heard_ns: int
    shown: bool
    answered: bool = False
    open: bool = True

    @property
    def urgency(self) -> tuple[bool, float, int]:
        """Sorts the most urgent first: who stands still, then by doubt, then who asked first."""
        return not self.help.waits_s, -self.help.doubt, self.help.time_ns


class Calls:
    """The last call of each robot, and how often robots were helped."""

    def __init__(self, clock: Clock, per_hour: int, metrics: Metrics) -> None:
        """per_hour: calls of all robots together that are shown within any hour; 0: no limit."""
        self._clock, self._metrics = clock, metrics
        self._budget = Budget(per_hour)
        self._changed: Callable[[], None] = _unheard
        self._calls: dict[str, Call] = {}
        self._lock = threading.Lock()

    def on_change(self, changed: Callable[[], None]) -> None:
        """Have `changed()` called after each change of the queue, in the thread that made it."""
        self._changed = changed

    def tell(self, robot: str, help: Help | None, time_ns: int) -> None:
        """What a robot said of its call at a time of its own; older than what is known is nothing.

        Any thread. None: it goes on confidently, was answered, or its episode is over.
        """
        with self._lock:
            known = self._calls.get(robot)
            if known and time_ns < known.time_ns:
                return
            if help is None:
                if known is None or not known.open:
                    return
                call = replace(known, open=False, time_ns=time_ns)
            elif known and known.help.decision == help.decision:
                call = self._go_on(known, help, time_ns)
            else:
                call = self._begin(robot, help, time_ns)
            self._calls[robot] = call
        if known is None or _look(known) != _look(call):
            self._changed()

    def answer(self, correction: Correction, receipt: Receipt) -> None:
        """A correction took force: sooner known than by the next heartbeat.

        A heartbeat may have overtaken the receipt, and told that the call is over but not why.
        """
        if not (receipt.accepted and correction.kind.answers):
            return
        with self._lock:
            call = self._calls.get(correction.robot)
            meant = call is not None and call.help.time_ns <= receipt.time_ns
            if call is None or not meant or call.answered:
                return
            if not call.open and call.time_ns < receipt.time_ns:
                return  # It had been taken back before.
            time_ns = max(call.time_ns, receipt.time_ns)
            self._calls[call.robot] = replace(call, answered=True, open=False, time_ns=time_ns)
            if call.shown:
                self._metrics.help_answered.inc()
        self._changed()

    def queue(self) -> list[Call]:
        """The calls that are open and shown, most urgent first; `waits_s` is what is left now."""
        now_ns = self._clock.monotonic_ns()
        with self._lock:
            calls = [call for call in self._calls.values() if call.open and call.shown]
        return sorted((_left(call, now_ns) for call in calls), key=lambda call: call.urgency)

    def suppressed(self) -> int:
        """How many calls are open that are beyond the budget."""
        with self._lock:
            return sum(call.open and not call.shown for call in self._calls.values())

    def _begin(self, robot: str, help: Help, time_ns: int) -> Call:
        self._metrics.help_asked.labels(help.reason).inc()
        shown = self._budget.spend(self._clock.now_ns())
        if not shown:
            self._metrics.help_suppressed.inc()
        return Call(robot, help, time_ns, self._clock.monotonic_ns(), shown)

    def _go_on(self, known: Call, help: Help, time_ns: int) -> Call:
        if known.help.waits_s and not help.waits_s:
            self._metrics.help_expired.inc()
        # One that was beyond the budget is shown as soon as there is room, if it still asks.
        shown = known.shown or (known.open and self._budget.spend(self._clock.now_ns()))
        heard_ns = self._clock.monotonic_ns()
        return replace(known, help=help, time_ns=time_ns, heard_ns=heard_ns, shown=shown)


def _look(call: Call) -> tuple[object, ...]:
    """What can be seen of a call, but for the time that runs."""
    return call.help.decision, call.open, call.shown, call.help.doubt, bool(call.help.waits_s)


def _left(call: Call, now_ns: int) -> Call:
    if not call.help.waits_s:
        return call
    left_s = max(0.0, call.help.waits_s - (now_ns - call.heard_ns) / 1e9)
    return replace(call, help=call.help.model_copy(update={"waits_s": left_s}))


def _unheard() -> None:
    """Nobody listens before `on_change`."""
