"""What can be said about an episode and a decision, by what was heard of them."""

import asyncio
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from services.correction_api.problems import Problem
from services.correction_api.topic import Topics
from services.correction_api.utterance import Utterance
from services.correction_api.watch import REMEMBERED, Watch
from shared.clock import ManualClock
from shared.messages.decision import Decision, Proposal
from shared.messages.goal import LanguageGoal
from shared.messages.heartbeat import RobotHeartbeat, RobotState
from shared.messages.policy import Version
from tests.unit.correction_api.store import opened_store

ROBOT = "robot-1"


@pytest.fixture
def watch() -> Watch:
    """A service that was just started, and has heard that robot-1 is in episode ep-b."""
    watch = Watch(ManualClock(), stale_s=2, offline_s=6)
    beat(watch, "ep-b", 1)
    return watch


@pytest.fixture
def topics(watch: Watch, tmp_path: Path) -> Iterator[Topics]:
    with opened_store(tmp_path / "a.sqlite") as store:
        yield Topics(watch, store.episodes)


def beat(watch: Watch, episode: str | None, time_ns: int) -> None:
    watch.robot(
        RobotHeartbeat(
            robot=ROBOT,
            actor="a",
            time_ns=time_ns,
            state=RobotState.ACTING,
            number=0,
            episode=episode,
            version=Version(1, 0),
        )
    )


def decide(watch: Watch, episode: str, index: int, time_ns: int = 1) -> None:
    goal = LanguageGoal(text="wait")
    watch.decision(
        Decision(
            id=f"{episode}-{index}",
            robot=ROBOT,
            episode=episode,
            index=index,
            step=index * 20,
            time_ns=time_ns,
            task="sandwich",
            prompt="make a sandwich",
            proposed=(Proposal(goal=goal, score=0.5),),
            executed=goal,
            chosen_by="1.0",
            version=Version(1, 0),
            arrays={
                "images": np.zeros((2, 64, 64, 3), np.uint8),
                "proprioception": np.zeros(22, np.float32),
                "objects": np.zeros((9, 9), np.float32),
            },
        )
    )


def place(topics: Topics, watch: Watch, **about: str) -> tuple[str, int | None]:
    said = Utterance.model_validate({"kind": "override", "text": "wait", **about})
    return asyncio.run(topics.find(ROBOT, said, watch.look(ROBOT)))


def refused(topics: Topics, watch: Watch, **about: str) -> Problem:
    with pytest.raises(Problem) as caught:
        place(topics, watch, **about)
    return caught.value


def test_a_forgotten_decision_of_an_episode_before_is_never_taken_for_the_current_one(
    topics: Topics, watch: Watch
) -> None:
    problem = refused(topics, watch, decision="ep-a-3")
    assert (problem.status_code, problem.name) == (409, "unknown-episode")
    now = "ep-a of robot-1 is unknown, or over for long; the current one is ep-b"
    assert now in problem.detail
    assert problem.extensions["current"]["episode"] == "ep-b"


def test_a_decision_that_many_others_followed_is_still_of_its_episode(
    topics: Topics, watch: Watch
) -> None:
    for index in range(REMEMBERED + 5):
        decide(watch, "ep-b", index)
    assert place(topics, watch, decision="ep-b-0") == ("ep-b", None)
    beat(watch, "ep-c", 2)
    problem = refused(topics, watch, decision="ep-b-0")
    assert (problem.status_code, problem.name) == (409, "episode-over")
    assert problem.detail == "episode ep-b of robot-1 is over; the current one is ep-c"


def test_an_episode_of_which_only_a_decision_was_heard_is_over_when_another_runs(
    topics: Topics, watch: Watch
) -> None:
    decide(watch, "ep-a", 0)
    decide(watch, "ep-b", 0)
    assert refused(topics, watch, episode="ep-a").name == "episode-over"


def test_a_decision_that_was_never_made_is_unknown_and_the_newest_is_named(
    topics: Topics, watch: Watch
) -> None:
    decide(watch, "ep-b", 4)
    problem = refused(topics, watch, decision="ep-b-5")
    assert (problem.status_code, problem.name) == (404, "unknown-decision")
    assert problem.detail == "no decision 'ep-b-5' of robot-1; the newest is ep-b-4"
    assert place(topics, watch, decision="ep-b-4") == ("ep-b", 80)
    assert place(topics, watch, decision="ep-b-3") == ("ep-b", None)


@pytest.mark.parametrize("name", ["nonsense", "ep-b-", "ep-b-04", "-3", "ep-b-x"])
def test_what_has_not_the_form_of_a_decision_is_unknown(
    topics: Topics, watch: Watch, name: str
) -> None:
    problem = refused(topics, watch, decision=name)
    assert (problem.status_code, problem.name) == (404, "unknown-decision")
    assert problem.detail == f"no decision '{name}' of robot-1; none was heard of yet"


def test_the_robot_judges_a_decision_when_none_of_its_episode_was_heard(
    topics: Topics, watch: Watch
) -> None:
    assert place(topics, watch, decision="ep-b-7") == ("ep-b", None)


def test_a_new_episode_may_be_told_by_a_decision_sooner_than_by_a_heartbeat(
    topics: Topics, watch: Watch
) -> None:
    decide(watch, "ep-c", 0, time_ns=0)  # Dated before the heartbeat that still names ep-b.
    assert place(topics, watch, decision="ep-c-0") == ("ep-c", 0)
    assert place(topics, watch, episode="ep-c") == ("ep-c", None)


def test_an_episode_that_nobody_heard_of_is_called_unknown(topics: Topics, watch: Watch) -> None:
    problem = refused(topics, watch, episode="ep-gone")
    assert (problem.status_code, problem.name) == (409, "unknown-episode")
    assert "ep-gone of robot-1 is unknown" in problem.detail
    beat(watch, None, 2)
    assert "no other has begun" in refused(topics, watch, episode="ep-gone").detail
    assert refused(topics, watch).name == "no-episode"


def test_a_decision_of_another_episode_than_the_one_given_is_refused(
    topics: Topics, watch: Watch
) -> None:
    problem = refused(topics, watch, decision="ep-a-3", episode="ep-b")
    assert problem.status_code == 422
    assert "ep-a-3 is of episode ep-a, not of ep-b; leave episode out" in problem.detail
