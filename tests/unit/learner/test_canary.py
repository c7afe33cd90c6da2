"""When a version that some robots run first is let on to all, waited for, or taken back."""

from typing import Any

import pytest

from services.learner.canary import CanarySettings, Finding, judge
from shared.messages.episode import Episode, Outcome
from tests.unit.learner.records import episode

SETTINGS = CanarySettings(robots=("robot-1", "robot-2"), episodes=3, within_s=60)


def ran(count: int, **over: Any) -> list[Episode]:
    return [episode(f"e-{number}", **over) for number in range(count)]


def test_a_version_that_does_as_well_as_the_one_before_passes() -> None:
    assert judge(ran(3), ran(1), 5, SETTINGS) == Finding(True)


@pytest.mark.parametrize(
    ("mine", "before", "missing"),
    [
        (ran(2), ran(9), "robot-1, robot-2 finished 2 of 3 episodes"),
        (ran(2) + ran(2, outcome=Outcome.ABORTED), ran(9), "finished 2 of 3 episodes"),
        (ran(3), [], "no episode ended under the version before, to compare with"),
        (ran(3), ran(4, outcome=Outcome.ABORTED), "no episode ended under the version before"),
    ],
)
def test_what_is_missing_is_told_waited_for_and_in_the_end_a_reason_to_go_back(
    mine: list[Episode], before: list[Episode], missing: str
) -> None:
    waits = judge(mine, before, 59, SETTINGS)
    assert not waits.over
    assert missing in waits.reason
    assert "60 s at most" in waits.reason
    gives_up = judge(mine, before, 60, SETTINGS)
    assert gives_up.over
    assert missing in gives_up.reason
    assert "gate.canary.within_s" in gives_up.reason


@pytest.mark.parametrize(
    ("mine", "why"),
    [
        (ran(3, outcome=Outcome.TIMEOUT), "success fell from 1.00 (n = 4) to 0.00 (n = 3)"),
        (ran(3, corrections=2), "2.0 times an episode instead of 0.0"),
    ],
)
def test_a_version_that_does_worse_goes_back_with_both_figures(
    mine: list[Episode], why: str
) -> None:
    found = judge(mine, ran(4), 5, SETTINGS)
    assert found.over
    assert why in found.reason
