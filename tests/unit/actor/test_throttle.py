"""Pictures give way to a control loop that falls behind, and come back when it keeps its time."""

import pytest

from services.actor.throttle import LEAST, MORE, Throttle

PERIOD_NS = 20_000_000
SECOND = 50  # turns


@pytest.fixture
def throttle():
    return Throttle()


def turn(throttle, seconds, late_ns=0):
    """So many seconds, each turn late by as much."""
    turns = round(seconds * SECOND * PERIOD_NS / (PERIOD_NS + late_ns)) + 1
    for _ in range(turns):
        throttle.turned(PERIOD_NS + late_ns, late_ns)


def test_a_loop_that_keeps_its_time_gives_pictures_their_whole_rate(throttle):
    turn(throttle, 10)
    assert throttle.share == 1.0


def test_a_loop_that_now_and_then_is_a_little_late_does_not_slow_them(throttle):
    turn(throttle, 10, late_ns=PERIOD_NS // 50)
    assert throttle.share == 1.0


def test_each_second_behind_halves_them_down_to_what_a_person_has_to_see(throttle):
    turn(throttle, 1, late_ns=PERIOD_NS)
    assert throttle.share == 0.5
    turn(throttle, 20, late_ns=PERIOD_NS)
    assert throttle.share == LEAST


def test_they_come_back_slowly_and_no_further_than_their_rate(throttle):
    turn(throttle, 1, late_ns=PERIOD_NS)
    turn(throttle, 1)
    assert throttle.share == pytest.approx(0.5 + MORE)
    turn(throttle, 60)
    assert throttle.share == 1.0


def test_one_long_stall_slows_them_once(throttle):
    throttle.turned(10_000_000_000, 10_000_000_000 - PERIOD_NS)
    assert throttle.share == 0.5
