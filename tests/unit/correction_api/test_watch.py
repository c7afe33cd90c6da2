"""The board: newest wins, silence is noticed, repetitions are no news."""

import numpy as np
import pytest

from services.correction_api.views import Presence
from services.correction_api.watch import REMEMBERED, Watch
from shared.clock import ManualClock
from shared.messages.decision import Decision, Proposal
from shared.messages.goal import LanguageGoal
from shared.messages.heartbeat import LearnerHeartbeat, LearnerState, RobotHeartbeat, RobotState
from shared.messages.policy import Version
from tests.unit.correction_api.store import correction, receipt

S = 1_000_000_000


def heartbeat(
    time_ns: int, episode: str | None = "robot-1-e1", command: str = "wait"
) -> RobotHeartbeat:
    return RobotHeartbeat(
        robot="robot-1",
        actor="actor-1",
        time_ns=time_ns,
        state=RobotState.ACTING,
        episode=episode,
        number=1,
        command=LanguageGoal(text=command),
        chosen_by="1.0",
        version=Version(1, 0),
    )


def decision(name: str, time_ns: int, episode: str = "robot-1-e1") -> Decision:
    goal = LanguageGoal(text=f"command of {name}")
    return Decision(
        id=name,
        robot="robot-1",
        episode=episode,
        index=0,
        step=0,
        time_ns=time_ns,
        task="sandwich",
        prompt="make a sandwich",
        proposed=(Proposal(goal=goal, score=1.0),),
        executed=goal,
        chosen_by="1.0",
        version=Version(1, 0),
        arrays={
            "images": np.zeros((2, 64, 64, 3), np.uint8),
            "proprioception": np.zeros(22, np.float32),
            "objects": np.zeros((9, 9), np.float32),
        },
    )


def learner(name: str, version: Version) -> LearnerHeartbeat:
    state = LearnerState.COLLECTING
    return LearnerHeartbeat(learner=name, time_ns=1, state=state, version=version, round=0)


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@pytest.fixture
def watch(clock: ManualClock) -> Watch:
    return Watch(clock, stale_s=2, offline_s=6)


def test_a_robot_that_falls_silent_is_stale_and_then_offline(
    watch: Watch, clock: ManualClock
) -> None:
    watch.robot(heartbeat(1))
    found = []
    for _ in range(4):
        found.append(watch.presence(watch.look("robot-1").heard_ns)[0])
        clock.advance(2 * S)
    assert found == [Presence.ONLINE, Presence.STALE, Presence.STALE, Presence.OFFLINE]
    watch.robot(heartbeat(2))
    assert watch.presence(watch.look("robot-1").heard_ns)[0] is Presence.ONLINE


def test_the_command_in_force_is_the_newest_that_was_told(watch: Watch) -> None:
    watch.robot(heartbeat(10))
    watch.decision(decision("d-1", 20))
    watch.robot(heartbeat(15, command="older"))
    force = watch.look("robot-1").force
    assert force is not None
    assert force.text == "command of d-1"
    watch.obeyed(correction("c-1"), receipt("c-1").model_copy(update={"time_ns": 30}))
    force = watch.look("robot-1").force
    assert force is not None
    assert (force.text, force.chosen_by) == ("wait", "c-1")


def test_a_refused_correction_changes_no_command(watch: Watch) -> None:
    watch.robot(heartbeat(10, command="put it down"))
    watch.obeyed(correction("c-1"), receipt("c-1", reason="no").model_copy(update={"time_ns": 30}))
    force = watch.look("robot-1").force
    assert force is not None
    assert force.text == "put it down"


def test_a_decision_that_is_repeated_is_no_news(watch: Watch) -> None:
    heard = []
    watch.robot(heartbeat(1))
    watch.on_change(lambda kind, name: heard.append((kind, name)))
    for _ in range(3):
        watch.decision(decision("d-1", 5))
    assert heard == [("decision", "robot-1")]


def test_a_decision_that_comes_before_the_first_heartbeat_is_not_lost(watch: Watch) -> None:
    watch.decision(decision("d-1", 5))
    assert watch.names() == []
    watch.robot(heartbeat(6))
    newest = watch.look("robot-1").decision
    assert newest is not None
    assert newest.id == "d-1"
    assert dict(newest.arrays) == {}


def test_an_episode_is_over_when_the_next_one_has_begun(watch: Watch) -> None:
    watch.robot(heartbeat(1, "robot-1-e1"))
    watch.robot(heartbeat(2, "robot-1-e2"))
    assert watch.ended("robot-1", "robot-1-e1")
    assert not watch.ended("robot-1", "robot-1-e2")
    assert watch.look("robot-1").episode == "robot-1-e2"
    watch.decision(decision("d-1", 3, "robot-1-e3"))
    assert watch.look("robot-1").episode == "robot-1-e3"
    watch.robot(heartbeat(4, None))
    assert watch.look("robot-1").episode is None
    assert watch.ended("robot-1", "robot-1-e2")


def test_only_the_last_decisions_are_remembered(watch: Watch) -> None:
    watch.robot(heartbeat(1))
    for number in range(REMEMBERED + 10):
        watch.decision(decision(f"d-{number}", number))
    assert watch.decided("robot-1", "d-9") is None
    assert watch.decided("robot-1", "d-10") is not None


def test_a_learner_of_an_older_epoch_is_not_heard(watch: Watch) -> None:
    assert watch.learner_now()[1] is Presence.UNSEEN
    watch.learner(learner("new", Version(2, 0)))
    watch.learner(learner("old", Version(1, 9)))
    now = watch.learner_now()[0]
    assert now is not None
    assert now.learner == "new"
