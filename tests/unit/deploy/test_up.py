"""What `hld up` tells its actors."""

import inspect
from pathlib import Path

import pytest

from deploy import hld
from deploy.up import Plan, actor_sets, evaluator_sets, learner_gate, learner_labels
from services.actor.config import ActorSettings
from services.learner.config import LearnerSettings
from shared.config import load


def settings(pace: str, *sets: str) -> ActorSettings:
    """Of the first robot's actor, as its process would read them."""
    plan = planned(pace, *sets)
    return load(ActorSettings, "actor", sets=actor_sets(plan, 0)[1::2], environment={})


def planned(pace: str, *sets: str, gate: int = 0) -> Plan:
    return Plan(
        oracle=pace == "lockstep",
        robots=2,
        rounds=0,
        episodes=0,
        evaluate=0,
        gate=gate,
        report=None,
        site="far",
        tasks=("pack",),
        pace=pace,
        seed=0,
        port=8000,
        router_port=7447,
        data=Path("runs/up"),
        fresh=False,
        sets=sets,
    )


def learner(told: list[str]) -> LearnerSettings:
    """What its process would make of it."""
    return load(LearnerSettings, "learner", sets=told[1::2], environment={})


def test_labels_anticipate_as_much_as_the_robots_high_level_is_slow() -> None:
    plan = planned("lockstep", "actor.rollout.latency_steps=30")
    assert learner(learner_labels(plan)).labels.anticipate_steps == 30
    assert learner_labels(planned("lockstep")) == []


def test_candidates_are_tried_in_what_the_robots_do() -> None:
    plan = planned("lockstep", "actor.rollout.hysteresis=0.1", "actor.low_level=x", gate=7)
    trials = learner(learner_gate(plan)).gate.trials
    assert (trials.episodes, trials.site, trials.tasks) == (7, "far", ("pack",))
    assert trials.rollout.hysteresis == 0.1
    tried = load(ActorSettings, "actor", sets=evaluator_sets(plan)[1::2], environment={})
    assert (tried.mode, str(tried.low_level), tried.nice) == ("evaluation", "x", 0)
    timed = evaluator_sets(planned("real-time", gate=7))  # There robots have to keep time.
    assert load(ActorSettings, "actor", sets=timed[1::2], environment={}).nice > 0
    assert learner_gate(planned("lockstep")) == []


def test_for_people_robots_say_when_they_are_in_doubt_and_go_on_meanwhile() -> None:
    help = settings("real-time").help
    assert (help.threshold, help.stuck_steps, help.wait_s) == (0.6, 150, 0.0)


def test_in_lockstep_nobody_asks_unless_it_is_set() -> None:
    assert settings("lockstep").help == ActorSettings().help
    assert settings("lockstep", "actor.help.threshold=0.5").help.threshold == 0.5


@pytest.mark.parametrize("pace", ["real-time", "lockstep"])
def test_what_is_set_by_hand_outdoes_what_the_pace_suggests(pace: str) -> None:
    assert settings(pace, "actor.help.wait_s=20").help.wait_s == 20


def test_candidates_are_tried_unless_somebody_says_otherwise() -> None:
    assert inspect.signature(hld.up).parameters["gate"].default > 0
