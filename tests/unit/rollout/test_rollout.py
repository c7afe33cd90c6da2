"""What the rollout promises, held against parts that only count."""

from concurrent.futures import Future

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shared.messages.correction import Kind
from shared.messages.decision import Decision
from shared.rollout.thinking import Lockstep
from tests.unit.rollout.fakes import (
    CountingRobot,
    KnowingLowLevel,
    SayingHighLevel,
    rollout_of,
    said,
)


def advance(rollout, steps):
    for _ in range(steps):
        assert rollout.advance()


def test_the_high_level_is_asked_every_n_steps_and_the_low_level_moves_in_between():
    decisions: list[Decision] = []
    rollout = rollout_of("go left", decisions=decisions, decision_steps=20)
    advance(rollout, 65)
    assert [decision.step for decision in decisions] == [0, 20, 40, 60]
    assert [decision.index for decision in decisions] == [0, 1, 2, 3]
    assert {decision.executed.text for decision in decisions} == {"go left"}
    assert {decision.chosen_by for decision in decisions} == {"1.0"}


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


def test_the_high_level_looks_at_once_after_an_interjection():
    decisions: list[Decision] = []
    rollout = rollout_of("left", decisions=decisions, decision_steps=100)
    advance(rollout, 13)
    rollout.correct(said(Kind.OVERRIDE, "up"))
    advance(rollout, 1)
    assert [decision.step for decision in decisions] == [0, 13]


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


def test_a_correction_after_the_end_is_refused():
    rollout = rollout_of("left", max_steps=3)
    advance(rollout, 3)
    assert rollout.over
    assert not rollout.advance()
    assert "over" in rollout.correct(said(Kind.OVERRIDE, "up")).reason


def test_the_episode_ends_at_success():
    rollout = rollout_of("left", robot=CountingRobot(done_at=4))
    advance(rollout, 4)
    assert rollout.over
    assert rollout.done


def test_a_paused_robot_stands_and_its_steps_do_not_count():
    robot = CountingRobot()
    rollout = rollout_of("left", robot=robot)
    advance(rollout, 2)
    rollout.correct(said(Kind.PAUSE))
    assert not rollout.advance()
    assert rollout.step == len(robot.actions) == 2
    rollout.correct(said(Kind.RESUME))
    assert rollout.advance()


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


def test_an_answer_that_comes_late_is_in_force_late_but_says_what_was_seen():
    robot = CountingRobot()
    decisions: list[Decision] = []
    thinking = Lockstep(latency_steps=4)
    rollout = rollout_of(
        "left",
        "rightward",
        thinking=thinking,
        robot=robot,
        decisions=decisions,
        decision_steps=10,
        latency_steps=4,
    )
    advance(rollout, 20)
    assert [decision.step for decision in decisions] == [0, 10]
    assert [int(action[0]) for action in robot.actions] == [4] * 14 + [9] * 6


def test_a_slow_high_level_never_stalls_the_robot():
    class Never:
        def __init__(self):
            self.answers = [True]
            self.future: Future = Future()

        def ask(self, high_level, observation, past):
            self.proposals = high_level.propose(observation, past)

        def answer(self, step):
            del step
            return self.proposals if self.answers and self.answers.pop() else None

        def close(self):
            pass

    decisions: list[Decision] = []
    rollout = rollout_of("left", thinking=Never(), decisions=decisions, decision_steps=5)
    advance(rollout, 50)
    assert len(decisions) == 1


def test_the_high_level_is_shown_the_commands_that_were_in_force_before():
    high_level = SayingHighLevel("a", "b", "c")
    rollout = rollout_of(high_level=high_level, decision_steps=10, history=2)
    advance(rollout, 12)
    rollout.correct(said(Kind.OVERRIDE, "x"))
    advance(rollout, 20)
    assert high_level.seen[0].previous == ()
    assert high_level.seen[1].previous == ("a",)
    assert high_level.seen[-1].previous[-1] == "x"
    assert all(len(seen.previous) <= 2 for seen in high_level.seen)


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


words = st.tuples(
    st.integers(0, 60),
    st.sampled_from([Kind.OVERRIDE, Kind.RELEASE, Kind.APPROVE, Kind.RETRACT, Kind.EDIT]),
    st.sampled_from(["up", "down", "sideways"]),
    st.one_of(st.none(), st.integers(1, 30)),
    st.integers(0, 7),
)


@settings(max_examples=60, deadline=None)
@given(st.lists(words, max_size=8))
def test_the_command_in_force_follows_from_decisions_corrections_and_receipts(spoken):
    """Nothing but what travels is needed to know what was in force at each step."""
    robot = CountingRobot()
    decisions: list[Decision] = []
    rollout = rollout_of("left", robot=robot, decisions=decisions, decision_steps=10)
    told = []
    for at, kind, text, hold, about in sorted(spoken, key=lambda word: word[0]):
        while rollout.step < at:
            rollout.advance()
        correction = said(
            kind,
            text if kind in (Kind.OVERRIDE, Kind.EDIT) else None,
            hold_steps=hold if kind is Kind.OVERRIDE else None,
            target=named(told, about) if kind in (Kind.RETRACT, Kind.EDIT) else None,
        )
        told.append((correction, rollout.correct(correction)))
    while rollout.step < 80:
        rollout.advance()
    for step, action in enumerate(robot.actions):
        assert int(action[0]) == len(in_force(step, told) or "left")


def named(told, about):
    """The id of something that was said before, if anything was."""
    return told[about % len(told)][0].id if told else "co-gone"


def in_force(step, told):
    """The override that holds at `step`, from corrections and receipts alone."""
    text = holder = end = None
    for correction, receipt in told:
        if not receipt.accepted or receipt.step > step:
            continue
        if end is not None and receipt.step >= end:
            text = holder = end = None
        if correction.kind is Kind.OVERRIDE:
            text, holder = correction.goal.text, correction.id
            end = receipt.step + correction.hold_steps if correction.hold_steps else None
        elif correction.kind is Kind.EDIT and correction.target == holder:
            text = correction.goal.text
        elif correction.kind is Kind.RELEASE or (
            correction.kind is Kind.RETRACT and correction.target == holder
        ):
            text = holder = end = None
    return None if end is not None and step >= end else text
