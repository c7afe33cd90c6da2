"""The control loop in real time: late turns are never made up for, and pictures give way to it."""

import itertools
import threading

import pytest

from services.actor.config import Pace
from services.actor.loop import run
from services.actor.throttle import LEAST, Throttle
from shared.clock import ManualClock
from shared.service import Stop


class Taking:
    """A robot whose turn takes so long, until the end is asked for after so many."""

    def __init__(self, clock, stop, turns, turn_ns):
        self._clock, self._stop, self._left, self._turn_ns = clock, stop, turns, turn_ns
        self.began = []

    def tick(self):
        self.began.append(self._clock.monotonic_ns())
        self._clock.advance(self._turn_ns)
        self._left -= 1
        if not self._left:
            self._stop.set()
        return True

    def close(self):
        """Nothing is open."""


def turned(turn_ns, turns=500):
    clock, stop, throttle = ManualClock(), Stop(), Throttle()
    runner = Taking(clock, stop, turns, turn_ns)
    run([runner], Pace.REAL_TIME, 50.0, clock, stop, threading.Event(), throttle)
    return runner.began, throttle.share


def test_turns_that_are_done_in_time_come_at_the_rate_and_leave_pictures_theirs():
    began, share = turned(8_000_000)
    assert {after - before for before, after in itertools.pairwise(began)} == {20_000_000}
    assert share == 1.0


@pytest.mark.parametrize("turn_ns", [25_000_000, 60_000_000])
def test_turns_that_take_too_long_follow_at_once_and_pictures_give_way(turn_ns):
    began, share = turned(turn_ns)
    assert {after - before for before, after in itertools.pairwise(began)} == {turn_ns}
    assert share == LEAST
