"""Handing in words: what is known of a robot decides what can be said about it."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from services.correction_api.accept import Desk
from services.correction_api.metrics import Metrics
from services.correction_api.problems import Problem
from services.correction_api.watch import Watch
from shared.clock import ManualClock
from shared.messages.heartbeat import RobotHeartbeat, RobotState
from shared.messages.policy import Version
from tests.unit.correction_api.store import opened_store


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@pytest.fixture
def watch(clock: ManualClock) -> Watch:
    return Watch(clock, stale_s=2, offline_s=6)


@pytest.fixture
def desk(clock: ManualClock, watch: Watch, tmp_path: Path) -> Iterator[Desk]:
    with opened_store(tmp_path / "a.sqlite") as store:
        yield Desk(
            watch,
            store.log,
            store.episodes,
            clock,
            Metrics(),
            answer_s=2.0,
            settle_s=2.0,
            understood=lambda *_: None,
        )


def test_a_robot_is_unknown_only_after_a_while(desk: Desk, clock: ManualClock) -> None:
    with pytest.raises(Problem) as early:
        desk.find("robot-1")
    assert early.value.status_code == 503
    assert early.value.headers == {"Retry-After": "1"}
    clock.advance(2_000_000_000)
    with pytest.raises(Problem) as late:
        desk.find("robot-1")
    assert late.value.status_code == 404
    assert late.value.detail == "no robot 'robot-1'; no robot has been heard of yet"


def test_the_nearest_robots_are_named(desk: Desk, clock: ManualClock, watch: Watch) -> None:
    clock.advance(2_000_000_000)
    for name in ("robot-1", "robot-2"):
        state = RobotState.IDLE
        version = Version(1, 0)
        watch.robot(
            RobotHeartbeat(robot=name, actor="a", time_ns=1, state=state, number=0, version=version)
        )
    assert desk.find("robot-1").episode is None
    with pytest.raises(Problem, match="nearest known: 'robot-") as unknown:
        desk.find("robot-3")
    assert unknown.value.status_code == 404
