"""The control loop of an actor: every robot gets its turn, by the clock or as fast as it can."""

import threading
from collections.abc import Sequence

import structlog

from services.actor.act import Runner
from services.actor.config import Pace
from services.actor.throttle import Throttle
from shared.clock import Clock
from shared.service import Stop

STANDSTILL_S = 0.05  # When no robot can move: until something comes in, or a heartbeat is due.
LATE_REPORT_NS = 10_000_000_000
log = structlog.get_logger()


def run(
    runners: Sequence[Runner],
    pace: Pace,
    control_hz: float,
    clock: Clock,
    stop: Stop,
    wake: threading.Event,
    throttle: Throttle,
) -> None:
    """Turn until the end is asked for, then close every runner.

    throttle: told how well the loop keeps its time, in real time.
    """
    try:
        if pace is Pace.REAL_TIME:
            _real_time(runners, int(1e9 / control_hz), clock, stop, throttle)
        else:
            _lockstep(runners, stop, wake)
    finally:
        for runner in runners:
            runner.close()


def _real_time(
    runners: Sequence[Runner], period_ns: int, clock: Clock, stop: Stop, throttle: Throttle
) -> None:
    due = clock.monotonic_ns()
    turns = late = 0
    began, report = due, due + LATE_REPORT_NS
    while not stop:
        for runner in runners:
            runner.tick()
        turns += 1
        due += period_ns
        now = clock.monotonic_ns()
        late_ns = max(0, now - due)
        throttle.turned(period_ns + late_ns, late_ns)
        if late_ns:  # Never catch up by moving faster than the robot may.
            late += 1
            due = now
        clock.sleep_ns(due - now)
        if now >= report:
            lasted_s = round((now - began) / 1e9, 2)
            pictures = round(throttle.share, 2)
            log.info("control loop", turns=turns, late=late, lasted_s=lasted_s, pictures=pictures)
            turns, late, began, report = 0, 0, now, now + LATE_REPORT_NS


def _lockstep(runners: Sequence[Runner], stop: Stop, wake: threading.Event) -> None:
    while not stop:
        wake.clear()
        if not any([runner.tick() for runner in runners]):
            wake.wait(STANDSTILL_S)
