"""Pictures that another process draws."""

import os
import time

import numpy as np
import pytest

from services.actor.draw import NICE, Drawer
from shared.errors import NoAnswerError
from shared.workcell.station import Station

DEADLINE_S = 120.0


@pytest.fixture
def drawer():
    drawer = Drawer("workcell", "far")
    yield drawer
    drawer.close()


def test_a_picture_that_another_process_draws_is_the_one_that_the_robot_would_draw(drawer):
    robot = Station("far")
    robot.reset(1, "sandwich", None)
    snapshot = robot.snapshot()
    elsewhere, here = drawer.photographer(), robot.photographer()
    for camera in ("top", "angle"):
        pictures = [one.picture(snapshot, camera, 80, 60) for one in (elsewhere, here)]
        assert np.array_equal(*pictures)
    here.close()
    robot.close()


def test_a_process_that_died_is_started_again_in_a_while(drawer):
    robot = Station("far")
    robot.reset(1, "sandwich", None)
    first = drawer.picture(robot.snapshot(), "top", 64, 64)
    drawer._child.kill()
    deadline = time.monotonic() + DEADLINE_S
    again = None
    while again is None:
        assert time.monotonic() < deadline
        try:
            again = drawer.picture(robot.snapshot(), "top", 64, 64)
        except NoAnswerError:
            time.sleep(0.05)
    assert np.array_equal(first, again)
    robot.close()


def test_who_draws_yields_to_the_robots_in_their_session_and_is_not_ended_with_them(drawer):
    robot = Station("far")
    robot.reset(1, "sandwich", None)
    drawer.picture(robot.snapshot(), "top", 64, 64)
    robot.close()
    child = drawer._child.pid
    assert os.getpriority(os.PRIO_PROCESS, child) == min(19, os.nice(0) + NICE)
    assert os.getsid(child) == os.getsid(0)
    assert os.getpgid(child) == child


def test_who_draws_nothing_more_says_so(drawer):
    drawer.close()
    with pytest.raises(NoAnswerError, match="nobody draws"):
        drawer.picture(np.zeros(3), "top", 64, 64)
