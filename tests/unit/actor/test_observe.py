"""Which pictures are drawn: of what somebody watches, as often as they want, and once for all."""

import time
from types import SimpleNamespace

import pytest

from services.actor.config import FrameSettings
from services.actor.observe import Observer
from services.actor.throttle import Throttle
from shared.clock import ManualClock
from shared.messages.frame import Channel, Frame, Rate
from shared.wire.codec import decode
from shared.wire.keys import robot_key
from shared.wire.memory import MemoryBus
from tests.unit.rollout.fakes import CountingRobot

TURN_NS = 125_000_000
ROLLOUT = SimpleNamespace(episode="ep-1", step=7)


class Watching:
    """An observer whose clock a test turns, and those who watch it."""

    def __init__(self):
        self.bus, self.clock, self.robot = MemoryBus(), ManualClock(), CountingRobot()
        frames = FrameSettings(rate_hz=8.0, slow_hz=2.0)
        self.throttle = Throttle()
        self.observer = Observer(self.bus, "lab", "robot-1", self.clock, frames, self.throttle)
        self.due, self.drawn, self.frames = [], [], {}
        snapshot, picture = self.robot.snapshot, self.robot.picture
        self.robot.snapshot = lambda: self.due.append(1) or snapshot()
        self.robot.picture = lambda *size: self.drawn.append(size[1]) or picture(*size)

    def watch(self, camera, rate):
        channel = Channel(camera, rate)
        self.frames[channel] = []
        take = self.frames[channel].append
        key = robot_key("lab", "robot-1", channel.message)
        return self.bus.subscribe(key, lambda _, payload: take(decode(Frame, payload)))

    def turn(self, times):
        """So many turns of 1/8 s; at how many of them a picture was due."""
        before = len(self.due)
        for _ in range(times):
            self.observer.show(self.robot, ROLLOUT)
            self.clock.advance(TURN_NS)
        return len(self.due) - before

    def close(self):
        self.observer.close()
        self.bus.close()


@pytest.fixture
def watching():
    made = Watching()
    yield made
    made.close()


def test_a_robot_that_is_only_in_view_is_drawn_a_quarter_as_often(watching):
    watching.watch("angle", Rate.SLOW)
    assert watching.turn(8) == 2
    watching.watch("angle", Rate.FULL)
    assert watching.turn(8) == 8


@pytest.mark.parametrize(("rate", "of_32"), [(Rate.FULL, 32), (Rate.SLOW, 8)])
def test_while_the_control_loop_needs_the_time_both_rates_are_slowed_alike(watching, rate, of_32):
    watching.watch("angle", rate)
    assert watching.turn(32) == of_32
    watching.throttle.share = 0.5
    assert watching.turn(32) == of_32 / 2


def test_one_picture_does_for_both_rates_and_each_counts_its_own(watching):
    for rate in Rate:
        watching.watch("angle", rate)
    assert watching.turn(1) == 1
    deadline = time.monotonic() + 10
    while not all(watching.frames.values()):
        assert time.monotonic() < deadline
        time.sleep(0.001)
    assert watching.drawn == ["angle"]
    assert [frame.sequence for frames in watching.frames.values() for frame in frames] == [1, 1]


def test_what_nobody_watches_is_not_drawn(watching):
    subscription = watching.watch("top", Rate.SLOW)
    subscription.close()
    assert watching.turn(8) == 0


@pytest.mark.parametrize("rate", Rate)
def test_a_channel_is_told_by_its_key(rate):
    channel = Channel("angle", rate)
    assert Channel.parse(channel.message) == channel
