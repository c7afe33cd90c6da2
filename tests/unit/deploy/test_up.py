"""What `hld up` tells its actors."""

from pathlib import Path

import pytest

from deploy.up import Plan, actor_sets
from services.actor.config import ActorSettings
from shared.config import load


def settings(pace: str, *sets: str) -> ActorSettings:
    """Of the first robot's actor, as its process would read them."""
    plan = Plan(
        oracle=pace == "lockstep",
        robots=2,
        rounds=0,
        episodes=0,
        evaluate=0,
        gate=0,
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
    return load(ActorSettings, "actor", sets=actor_sets(plan, 0)[1::2], environment={})


def test_for_people_robots_say_when_they_are_in_doubt_and_go_on_meanwhile() -> None:
    help = settings("real-time").help
    assert (help.threshold, help.stuck_steps, help.wait_s) == (0.6, 150, 0.0)


def test_in_lockstep_nobody_asks_unless_it_is_set() -> None:
    assert settings("lockstep").help == ActorSettings().help
    assert settings("lockstep", "actor.help.threshold=0.5").help.threshold == 0.5


@pytest.mark.parametrize("pace", ["real-time", "lockstep"])
def test_what_is_set_by_hand_outdoes_what_the_pace_suggests(pace: str) -> None:
    assert settings(pace, "actor.help.wait_s=20").help.wait_s == 20
