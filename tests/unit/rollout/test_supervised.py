"""A supervised rollout: each decision waits for its verdict, and words take force when they say."""

import pytest

from shared.messages.correction import Kind
from shared.messages.decision import Decision
from tests.unit.rollout.fakes import CountingRobot, advance, rollout_of, said


def test_in_supervised_lockstep_every_decision_waits_for_its_verdict():
    decisions: list[Decision] = []
    rollout = rollout_of("left", decisions=decisions, supervised=True, decision_steps=5)
    assert not rollout.advance()
    assert decisions[0].awaits_verdict
    assert not rollout.advance()
    rollout.correct(said(Kind.APPROVE, decision=decisions[0].id))
    advance(rollout, 5)
    assert not rollout.advance()
    assert [decision.step for decision in decisions] == [0, 5]


def test_a_verdict_about_an_earlier_decision_does_not_free_the_robot():
    decisions: list[Decision] = []
    rollout = rollout_of("left", supervised=True, decisions=decisions, decision_steps=5)
    rollout.advance()
    rollout.correct(said(Kind.APPROVE, decision=decisions[0].id))
    advance(rollout, 5)
    rollout.advance()
    assert rollout.correct(said(Kind.APPROVE, decision=decisions[0].id)).accepted
    assert not rollout.advance()


@pytest.mark.parametrize("decision", ["ep-1-1", "ep-0-0", "nonexistent", "ep-1-x"])
def test_a_word_about_a_decision_that_was_never_taken_here_is_refused(decision):
    rollout = rollout_of("left", supervised=True)
    rollout.advance()
    receipt = rollout.correct(said(Kind.OVERRIDE, "up", decision=decision))
    assert not receipt.accepted
    assert "the newest is ep-1-0" in receipt.reason
    assert rollout.command.text == "left"


def test_a_supervised_correction_takes_effect_after_the_persons_delay():
    robot = CountingRobot()
    decisions: list[Decision] = []
    rollout = rollout_of("left", robot=robot, decisions=decisions, supervised=True)
    rollout.advance()
    correction = said(Kind.OVERRIDE, "rightward", decision=decisions[0].id, delay_steps=3)
    assert rollout.correct(correction).step == 3
    advance(rollout, 6)
    assert [int(action[0]) for action in robot.actions] == [4, 4, 4, 9, 9, 9]


def test_an_override_that_expires_does_not_take_the_coming_one_with_it():
    robot = CountingRobot()
    decisions: list[Decision] = []
    rollout = rollout_of(
        "left", robot=robot, decisions=decisions, supervised=True, decision_steps=10
    )
    rollout.advance()
    first = said(Kind.OVERRIDE, "up", decision=decisions[0].id, hold_steps=12)
    rollout.correct(first)
    advance(rollout, 10)
    rollout.advance()
    second = said(Kind.OVERRIDE, "rightward", decision=decisions[1].id, delay_steps=5)
    assert rollout.correct(second).step == 15
    advance(rollout, 2)  # Steps 10 and 11; the first override ends before step 12.
    rollout.advance()
    rollout.correct(said(Kind.PASS, decision=decisions[2].id))
    advance(rollout, 6)
    lengths = [int(action[0]) for action in robot.actions]
    assert lengths == [2] * 12 + [4] * 3 + [9] * 3


def test_delayed_words_take_force_in_turn_as_their_receipts_say():
    robot = CountingRobot()
    decisions: list[Decision] = []
    rollout = rollout_of(
        "left", robot=robot, decisions=decisions, supervised=True, decision_steps=5
    )
    rollout.advance()
    first = said(Kind.OVERRIDE, "up", decision=decisions[0].id, delay_steps=7)
    assert rollout.correct(first).step == 7
    advance(rollout, 5)
    rollout.advance()
    second = said(Kind.OVERRIDE, "rightward", decision=decisions[1].id, delay_steps=4)
    assert rollout.correct(second).step == 9
    advance(rollout, 5)
    lengths = [int(action[0]) for action in robot.actions]
    assert lengths == [4] * 7 + [2] * 2 + [9] * 1
