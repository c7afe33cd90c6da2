"""What is said of the past: taken back, put otherwise, about an episode that is over."""

import pytest

from shared.messages.correction import Kind
from shared.messages.decision import Decision
from tests.unit.rollout.fakes import (
    CountingRobot,
    KnowingLowLevel,
    advance,
    rollout_of,
    said,
)


def test_an_override_that_is_retracted_is_lifted_and_what_it_replaced_stays_away():
    decisions: list[Decision] = []
    rollout = rollout_of("left", decisions=decisions, decision_steps=100)
    rollout.advance()
    first, second = said(Kind.OVERRIDE, "up"), said(Kind.OVERRIDE, "down")
    rollout.correct(first)
    rollout.correct(second)
    advance(rollout, 3)
    receipt = rollout.correct(said(Kind.RETRACT, target=second.id))
    assert (receipt.step, receipt.replaced) == (4, second.id)
    assert (rollout.command.text, rollout.chosen_by) == ("left", "1.0")
    advance(rollout, 1)
    assert decisions[-1].step == 4  # The high level looks at once, as after a release.


def test_an_override_that_is_retracted_before_it_begins_never_does():
    robot, decisions = CountingRobot(), []
    rollout = rollout_of("left", robot=robot, decisions=decisions, supervised=True)
    rollout.advance()
    late = said(Kind.OVERRIDE, "rightward", decision=decisions[0].id, delay_steps=3)
    rollout.correct(late)
    assert rollout.correct(said(Kind.RETRACT, target=late.id)).replaced is None
    advance(rollout, 6)
    assert [int(action[0]) for action in robot.actions] == [4] * 6


def test_an_edit_puts_its_goal_in_force_for_as_long_as_the_first_was_to_hold():
    robot = CountingRobot()
    rollout = rollout_of("left", robot=robot)
    rollout.advance()
    first = said(Kind.OVERRIDE, "up", hold_steps=6)
    rollout.correct(first)
    advance(rollout, 2)
    receipt = rollout.correct(said(Kind.EDIT, "rightward", target=first.id))
    assert (receipt.step, receipt.replaced, rollout.chosen_by) == (3, first.id, first.id)
    advance(rollout, 6)
    assert [int(action[0]) for action in robot.actions] == [4] + [2] * 2 + [9] * 4 + [4] * 2


def test_an_edit_of_what_is_about_to_hold_changes_what_will():
    robot, decisions = CountingRobot(), []
    rollout = rollout_of("left", robot=robot, decisions=decisions, supervised=True)
    rollout.advance()
    late = said(Kind.OVERRIDE, "up", decision=decisions[0].id, delay_steps=2)
    rollout.correct(late)
    rollout.correct(said(Kind.EDIT, "rightward", target=late.id))
    advance(rollout, 4)
    assert [int(action[0]) for action in robot.actions] == [4, 4, 9, 9]


def test_an_edit_that_is_retracted_gives_the_words_before_it_back():
    robot = CountingRobot()
    rollout = rollout_of("left", robot=robot)
    rollout.advance()
    first = said(Kind.OVERRIDE, "up", hold_steps=6)
    rollout.correct(first)
    advance(rollout, 1)
    edits = [said(Kind.EDIT, text, target=first.id) for text in ("down", "rightward")]
    for edit in edits:
        rollout.correct(edit)
    advance(rollout, 1)
    # The one that no longer counts changes nothing; the override holds on, so it isn't replaced.
    assert rollout.correct(said(Kind.RETRACT, target=edits[0].id)).replaced is None
    advance(rollout, 1)
    assert rollout.correct(said(Kind.RETRACT, target=edits[1].id)).replaced is None
    assert (rollout.command.text, rollout.chosen_by) == ("up", first.id)
    advance(rollout, 4)
    assert [int(action[0]) for action in robot.actions] == [4] + [2] + [9] * 2 + [2] * 3 + [4]


def test_an_edit_is_refused_only_where_the_robot_would_have_to_do_it():
    rollout = rollout_of("left", low_level=KnowingLowLevel(knows=("left", "up")))
    rollout.advance()
    first = said(Kind.OVERRIDE, "up")
    rollout.correct(first)
    refused = rollout.correct(said(Kind.EDIT, "fly", target=first.id))
    assert "I don't know how to fly" in refused.reason
    assert rollout.command.text == "up"
    rollout.correct(said(Kind.RELEASE))
    assert rollout.correct(said(Kind.EDIT, "fly", target=first.id)).accepted
    relabel = said(Kind.RELABEL, "fly", first_step=0, end_step=1)
    assert rollout.correct(relabel).accepted
    assert rollout.command.text == "left"


@pytest.mark.parametrize(
    "correction",
    [
        said(Kind.RETRACT, target="co-gone"),
        said(Kind.EDIT, "up", target="co-gone"),
        said(Kind.RETIME, target="co-gone", first_step=0, end_step=2),
        said(Kind.RELABEL, "up", first_step=0, end_step=2),
        said(Kind.FAULT, decision="ep-1-0"),
    ],
    ids=lambda correction: correction.kind,
)
def test_what_is_said_of_the_past_changes_nothing_and_is_no_verdict(correction):
    rollout = rollout_of("left", supervised=True)
    rollout.advance()
    assert rollout.correct(correction).step == 0
    assert (rollout.command.text, rollout.chosen_by) == ("left", "1.0")
    assert not rollout.advance()
    assert rollout.awaited is not None


def test_what_is_said_of_an_episode_that_is_over_is_never_too_late():
    rollout = rollout_of("left", max_steps=3)
    first = said(Kind.OVERRIDE, "up")
    rollout.correct(first)
    advance(rollout, 3)
    assert rollout.correct(said(Kind.EDIT, "down", target=first.id)).accepted
    other = said(Kind.RELABEL, "up", first_step=0, end_step=9, episode="ep-0")
    assert rollout.correct(other).accepted
    assert not rollout.correct(said(Kind.FAULT, decision="ep-1-7", episode="ep-1")).reason
