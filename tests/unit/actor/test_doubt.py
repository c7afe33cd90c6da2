"""Whether a robot calls for help, from decisions alone."""

import itertools
import math

import pytest

from services.actor.config import HelpSettings
from services.actor.doubt import Doubt, doubt_of
from shared.messages.decision import Choice, Decision, Proposal
from shared.messages.goal import Goal
from shared.messages.help import Reason
from shared.messages.policy import Version
from tests.contract.samples import arrays

ARRAYS = arrays()


def decision(step=0, *scores, executed="go", choice=Choice.BEST):
    """At a step, with the scores of what is proposed; sure if none are given."""
    scores = scores or (1.0,)
    return Decision(
        id=f"ep-1-{step}",
        robot="robot-1",
        episode="ep-1",
        index=0,
        step=step,
        time_ns=step,
        task="pack",
        prompt="do it",
        proposed=tuple(
            Proposal(goal=Goal(text=f"goal {at}"), score=score) for at, score in enumerate(scores)
        ),
        executed=Goal(text=executed),
        chosen_by="1.0",
        choice=choice,
        version=Version(1, 0),
        arrays=ARRAYS,
    )


def look(doubt, seen, achieved=False, may_call=True):
    return doubt.look(seen, lambda: achieved, lambda: may_call)


def doubting(**settings):
    return Doubt(HelpSettings.model_validate({"pause_steps": 0} | settings))


def test_doubt_by_entropy_is_that_of_as_many_equal_goals():
    for count in (1, 2, 4, 10):
        seen = decision(0, *[1 / count] * count)
        assert doubt_of(seen, Reason.ENTROPY) == pytest.approx(1 - 1 / count)


def test_doubt_by_margin_is_what_is_missing_between_the_best_two():
    assert doubt_of(decision(0, 0.5, 0.3, 0.2), Reason.MARGIN) == pytest.approx(0.8)
    assert doubt_of(decision(0, 1.0), Reason.MARGIN) == 0
    assert decision(0, 0.25).entropy >= math.log(4)  # Far from sure, though there is no other.


def test_as_it_comes_a_robot_never_calls():
    doubt = Doubt(HelpSettings())
    assert all(look(doubt, decision(step, 0.5, 0.5)) is None for step in range(0, 2000, 20))


@pytest.mark.parametrize("measure", ["entropy", "margin"])
def test_an_unsure_robot_calls_and_says_why_and_how_much(measure):
    doubt = doubting(threshold=0.45, measure=measure)
    assert look(doubt, decision(0, 0.9, 0.1)) is None
    call = look(doubt, decision(20, 0.5, 0.5))
    assert (call.decision, call.step, call.reason) == ("ep-1-20", 20, measure)
    assert call.doubt == pytest.approx(0.5 if measure == "entropy" else 1.0)


def test_one_call_lasts_until_the_robot_is_clearly_sure_again():
    doubt = doubting(threshold=0.5, calm=0.5, measure="margin")
    assert look(doubt, decision(0, 0.75, 0.25)).decision == "ep-1-0"
    still = look(doubt, decision(20, 0.85, 0.15))
    assert (still.decision, still.doubt) == ("ep-1-0", pytest.approx(0.3))
    assert look(doubt, decision(40, 0.9, 0.1)) is None
    assert look(doubt, decision(60, 0.85, 0.15)) is None
    assert look(doubt, decision(80, 0.75, 0.25)).decision == "ep-1-80"


def test_after_an_answer_it_does_not_call_at_the_next_look_again():
    doubt = doubting(threshold=0.5, pause_steps=50)
    look(doubt, decision(0, 0.5, 0.5))
    doubt.close(10)
    calls = [look(doubt, decision(step, 0.5, 0.5)) for step in (20, 40, 60, 80)]
    assert calls[:2] == [None, None]
    assert {call.decision for call in calls[2:]} == {"ep-1-60"}


def test_while_a_persons_word_holds_the_high_levels_doubt_is_of_no_account():
    doubt = doubting(threshold=0.5)
    assert look(doubt, decision(0, 0.5, 0.5, choice=Choice.HELD)) is None


def test_one_command_for_long_of_which_nothing_comes_is_a_reason_to_call():
    doubt = doubting(stuck_steps=100)
    calls = [look(doubt, decision(step)) for step in range(0, 200, 20)]
    assert [call is not None for call in calls] == [False] * 5 + [True] * 5
    assert {call.decision for call in calls[5:]} == {"ep-1-100"}
    assert (calls[5].reason, calls[5].doubt) == (Reason.STUCK, 1.0)
    assert look(doubt, decision(200, executed="something else")) is None


def test_also_a_persons_word_gets_stuck():
    doubt = doubting(stuck_steps=40)
    look(doubt, decision(0, choice=Choice.HELD))
    assert look(doubt, decision(40, choice=Choice.HELD)).reason is Reason.STUCK


def test_that_a_command_is_done_excuses_it_once():
    doubt = doubting(stuck_steps=100)
    calls = [look(doubt, decision(step), achieved=True) for step in range(0, 260, 20)]
    assert [call is not None for call in calls] == [False] * 10 + [True] * 3


def test_after_an_answer_it_takes_as_long_again_to_be_stuck():
    doubt = doubting(stuck_steps=100)
    for step in range(0, 120, 20):
        look(doubt, decision(step))
    doubt.close(110)
    calls = [look(doubt, decision(step)) for step in range(120, 240, 20)]
    assert [call is not None for call in calls] == [False] * 5 + [True]


def test_commands_that_change_in_time_are_no_reason_to_call():
    doubt = doubting(stuck_steps=100)
    names = itertools.cycle(["left", "right", "ahead"])
    steps = range(0, 1000, 80)
    assert all(look(doubt, decision(step, executed=next(names))) is None for step in steps)


def test_two_commands_in_turn_again_and_again_are_a_reason_to_call():
    doubt, names = doubting(stuck_steps=100), itertools.cycle(["pick it up", "put it down"])
    steps = range(0, 1000, 80)
    calls = [look(doubt, decision(step, executed=next(names)), achieved=True) for step in steps]
    assert [call is not None for call in calls] == [False] * 5 + [True] * 8
    assert {(call.decision, call.reason) for call in calls[5:]} == {("ep-1-400", Reason.STUCK)}
    assert look(doubt, decision(1040, executed="wait")) is None


@pytest.mark.parametrize(("stuck_steps", "first"), [(100, 1280), (400, 1440)])
def test_after_an_answer_it_takes_a_whole_circle_again(stuck_steps, first):
    doubt, names = doubting(stuck_steps=stuck_steps), itertools.cycle(["left", "right"])
    for step in range(0, 1000, 80):
        look(doubt, decision(step, executed=next(names)))
    assert doubt.call
    doubt.close(1010)  # Told "yes, go on": it goes on as before.
    calls = [look(doubt, decision(step, executed=next(names))) for step in range(1040, 1600, 80)]
    assert next(call for call in calls if call).step == first


def test_another_command_breaks_the_circle():
    doubt, names = doubting(stuck_steps=100), itertools.cycle(["left", "right", "left", "ahead"])
    steps = range(0, 2000, 80)
    assert all(look(doubt, decision(step, executed=next(names))) is None for step in steps)


def test_a_flicker_between_two_commands_has_as_long_as_one_command():
    doubt, names = doubting(stuck_steps=300), itertools.cycle(["left", "right"])
    calls = [look(doubt, decision(step, executed=next(names))) for step in range(0, 400, 20)]
    first = next(call for call in calls if call)
    assert first.step == 300


def test_without_a_budget_it_does_not_call_and_without_a_reason_none_is_spent():
    doubt, asked = doubting(threshold=0.5), []
    doubt.look(decision(0, 0.9, 0.1), lambda: False, lambda: bool(asked.append(0)))
    assert asked == []
    assert look(doubt, decision(20, 0.5, 0.5), may_call=False) is None
    assert look(doubt, decision(40, 0.5, 0.5)).decision == "ep-1-40"
