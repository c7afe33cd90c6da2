"""What an override does to a rollout, until when it holds, and what is refused."""

import pytest

from shared.messages.correction import Kind
from shared.messages.decision import Decision
from tests.unit.rollout.fakes import CountingRobot, advance, rollout_of, said


def test_an_override_cuts_the_chunk_at_the_next_control_step():
    robot = CountingRobot()
    rollout = rollout_of("go left", robot=robot, execute_steps=10, decision_steps=100)
    advance(rollout, 3)
    receipt = rollout.correct(said(Kind.OVERRIDE, "go to the right"))
    advance(rollout, 2)
    assert receipt.accepted
    assert receipt.step == 3
    lengths = [int(action[0]) for action in robot.actions]
    assert lengths == [len("go left")] * 3 + [len("go to the right")] * 2


def test_an_override_holds_over_decisions_until_it_is_released():
    decisions: list[Decision] = []
    rollout = rollout_of("go left", decisions=decisions, decision_steps=10)
    advance(rollout, 5)
    correction = said(Kind.OVERRIDE, "stop")
    rollout.correct(correction)
    advance(rollout, 20)
    held = [decision for decision in decisions if decision.step >= 5]
    assert len(held) >= 2
    assert {decision.executed.text for decision in held} == {"stop"}
    assert {decision.chosen_by for decision in held} == {correction.id}
    assert {decision.proposed[0].goal.text for decision in held} == {"go left"}
    rollout.correct(said(Kind.RELEASE))
    assert rollout.command.text == "go left"
    assert rollout.chosen_by == "1.0"


def test_an_override_with_an_end_expires_to_the_step():
    robot = CountingRobot()
    rollout = rollout_of("left", robot=robot)
    rollout.advance()
    rollout.correct(said(Kind.OVERRIDE, "rightward", hold_steps=7))
    advance(rollout, 12)
    lengths = [int(action[0]) for action in robot.actions]
    assert lengths == [4] + [9] * 7 + [4] * 5


def test_a_later_override_replaces_the_one_that_holds_and_says_so():
    rollout = rollout_of("left")
    rollout.advance()
    first = said(Kind.OVERRIDE, "up")
    rollout.correct(first)
    receipt = rollout.correct(said(Kind.OVERRIDE, "down"))
    assert receipt.replaced == first.id
    assert rollout.command.text == "down"


@pytest.mark.parametrize(
    ("correction", "reason"),
    [
        (said(Kind.OVERRIDE, "up", episode="ep-0"), "ep-0 is over; the current one is ep-1"),
        (said(Kind.RELEASE), "no override holds"),
        (said(Kind.RESUME), "not paused"),
    ],
)
def test_what_cannot_be_obeyed_is_refused_with_the_reason(correction, reason):
    rollout = rollout_of("left")
    rollout.advance()
    receipt = rollout.correct(correction)
    assert not receipt.accepted
    assert receipt.step is None
    assert reason in receipt.reason
    assert rollout.command.text == "left"
