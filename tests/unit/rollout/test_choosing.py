"""Which proposal takes force: no flicker, never against a word, nothing the low level can't do."""

from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shared.messages.correction import Kind
from shared.messages.decision import Asked, Choice, Decision
from shared.messages.policy import Version
from tests.unit.rollout.fakes import (
    CountingRobot,
    KnowingLowLevel,
    ScoringHighLevel,
    rollout_of,
    said,
)

steady = st.fixed_dictionaries(
    {},
    optional={
        "hysteresis": st.floats(0, 1),
        "smoothing": st.floats(0, 0.95),
        "dwell_steps": st.integers(0, 100),
    },
)


def decisions_of(scores, steps=100, **settings):
    """The decisions of a rollout whose high level scores "left" like this, look by look."""
    decisions: list[Decision] = []
    rollout = rollout_of(
        high_level=ScoringHighLevel(*scores), decisions=decisions, decision_steps=10, **settings
    )
    while rollout.step < steps:
        assert rollout.advance()
    return decisions


def texts(decisions):
    return [decision.executed.text for decision in decisions]


def test_without_settings_the_first_proposal_is_always_in_force():
    decisions = decisions_of([0.51, 0.49] * 5)
    assert texts(decisions) == ["left", "rightward"] * 5
    assert {decision.choice for decision in decisions} == {Choice.BEST}


def test_hysteresis_stops_a_flicker_but_not_a_change_of_mind():
    decisions = decisions_of([0.55, 0.45, 0.55, 0.45, 0.1], steps=50, hysteresis=0.2)
    assert texts(decisions) == ["left"] * 4 + ["rightward"]
    assert [decision.choice for decision in decisions] == [
        Choice.BEST,
        Choice.HYSTERESIS,
        Choice.BEST,
        Choice.HYSTERESIS,
        Choice.BEST,
    ]
    assert decisions[1].proposed[0].goal.text == "rightward"


def test_a_running_mean_stops_a_flicker_but_not_a_change_of_mind():
    decisions = decisions_of([0.9, 0.4, 0.9, 0.1, 0.1], steps=50, smoothing=0.5)
    assert texts(decisions) == ["left"] * 3 + ["rightward"] * 2
    assert decisions[1].choice is Choice.SMOOTHED
    assert decisions[1].proposed[0].goal.text == "rightward"


def test_a_command_dwells_before_the_high_level_may_change_it():
    decisions = decisions_of([0.9, 0.1], steps=40, dwell_steps=25)
    assert texts(decisions) == ["left"] * 3 + ["rightward"]
    assert [decision.choice for decision in decisions[1:3]] == [Choice.DWELL] * 2


def test_a_command_that_is_kept_was_chosen_by_the_version_that_chose_it():
    high_level, decisions = ScoringHighLevel(0.55, 0.45), []
    rollout = rollout_of(
        high_level=high_level, decisions=decisions, decision_steps=10, hysteresis=0.2
    )
    rollout.advance()
    newer = ScoringHighLevel(0.45)
    newer.version = Version(1, 7)
    rollout.take_up(newer)
    while rollout.step < 20:
        rollout.advance()
    assert [str(decision.version) for decision in decisions] == ["1.0", "1.7"]
    assert decisions[1].chosen_by == "1.0"


@pytest.mark.parametrize("setting", [{"hysteresis": 1.0}, {"dwell_steps": 1000}])
def test_what_is_achieved_or_stuck_has_no_claim_to_stay(setting):
    done = KnowingLowLevel(lambda step, text: float(step >= 20 and text == "left"))
    decisions = decisions_of([0.9, 0.1], low_level=done, replan="completion", **setting)
    assert texts(decisions) == ["left", "rightward"]
    decisions = decisions_of([0.9, 0.1], replan="completion", stuck_steps=30, **setting)
    assert texts(decisions)[:2] == ["left", "rightward"]
    assert decisions[1].asked is Asked.STUCK


def test_what_was_achieved_when_the_high_level_erred_has_no_claim_later_either():
    done = KnowingLowLevel(lambda step, text: float(step >= 5 and text == "left"))
    decisions = decisions_of(
        [0.9, 0.9, 0.1], low_level=done, replan="both", hysteresis=1.0, execute_steps=7
    )
    assert [decision.asked for decision in decisions[:3]] == [
        Asked.START,
        Asked.COMPLETION,
        Asked.INTERVAL,
    ]
    assert texts(decisions)[:3] == ["left", "left", "rightward"]


@settings(max_examples=60, deadline=None)
@given(
    steady,
    st.lists(st.floats(0, 1), min_size=1, max_size=10),
    st.lists(st.tuples(st.integers(0, 60), st.booleans()), max_size=5),
)
def test_no_guard_against_flicker_ever_delays_a_person(guards, scores, words):
    robot = CountingRobot()
    rollout = rollout_of(
        high_level=ScoringHighLevel(*scores), robot=robot, decision_steps=10, **guards
    )
    for at, ends in sorted(words):
        while rollout.step < at:
            rollout.advance()
        receipt = rollout.correct(said(Kind.OVERRIDE, "up"))
        assert receipt.step == rollout.step
        rollout.advance()
        assert int(robot.actions[-1][0]) == len("up")
        if ends:
            rollout.correct(said(Kind.RELEASE))
            rollout.advance()
            best = "left" if latest(rollout, scores) >= 0.5 else "rightward"
            assert rollout.command.text == best
            assert int(robot.actions[-1][0]) == len(best)


def latest(rollout, scores):
    """What the high level scored "left" with at its last look."""
    return scores[min(rollout.decisions, len(scores)) - 1]


@settings(max_examples=60, deadline=None)
@given(st.lists(st.floats(0, 1), min_size=2, max_size=20), steady)
def test_a_decision_says_why_the_first_proposal_is_not_in_force(scores, guards):
    for before, now in pairwise(decisions_of(scores, steps=200, **guards)):
        if now.choice in (Choice.HYSTERESIS, Choice.DWELL):
            assert now.executed == before.executed
        elif now.choice is Choice.BEST:
            assert now.executed == now.proposed[0].goal
        else:
            assert now.choice is Choice.SMOOTHED
            assert "smoothing" in guards


@settings(max_examples=60, deadline=None)
@given(st.lists(st.floats(0.4, 0.6), min_size=2, max_size=20))
def test_a_high_level_that_wavers_by_less_than_the_margin_changes_nothing(scores):
    assert len(set(texts(decisions_of(scores, steps=200, hysteresis=0.21)))) == 1


@settings(max_examples=60, deadline=None)
@given(st.lists(st.floats(0, 1), min_size=2, max_size=20), st.integers(0, 60))
def test_no_command_of_the_high_level_is_shorter_than_its_dwell(scores, dwell_steps):
    decisions = decisions_of(scores, steps=200, dwell_steps=dwell_steps)
    changes = [now.step for before, now in pairwise(decisions) if now.executed != before.executed]
    assert all(b - a >= dwell_steps for a, b in zip([0, *changes], changes, strict=False))


# -- what the low level objects to


def test_what_the_low_level_does_not_know_is_refused_with_what_it_knows():
    robot = CountingRobot()
    rollout = rollout_of("left", robot=robot, low_level=KnowingLowLevel(knows=["left", "up"]))
    rollout.advance()
    receipt = rollout.correct(said(Kind.OVERRIDE, "do a backflip"))
    assert not receipt.accepted
    assert receipt.reason == "I don't know how to do a backflip; I know: left, up"
    assert rollout.correct(said(Kind.OVERRIDE, "up")).accepted


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 60), st.booleans(), st.booleans(), st.booleans())
def test_a_refused_phrase_leaves_everything_as_it_was(at, held, supervised, paused):
    """The rest of the episode is the same to the step, whether or not it was said."""
    stories = []
    for refused in (False, True):
        robot, decisions = CountingRobot(), []
        rollout = rollout_of(
            "left",
            "rightward",
            robot=robot,
            decisions=decisions,
            supervised=supervised,
            low_level=KnowingLowLevel(knows=["left", "rightward", "up"]),
            decision_steps=15,
        )
        run(rollout, at)
        if held:
            rollout.correct(said(Kind.OVERRIDE, "up", hold_steps=20))
        if paused:
            rollout.correct(said(Kind.PAUSE))
        if refused:
            assert not rollout.correct(said(Kind.OVERRIDE, "fly")).accepted
        assert rollout.paused == paused
        if paused:
            rollout.correct(said(Kind.RESUME))
        run(rollout, at + 60)
        told = [(d.step, d.asked, d.choice, d.executed.text, d.previous) for d in decisions]
        stories.append((told, [int(action[0]) for action in robot.actions], rollout.corrections))
    assert stories[0] == stories[1]


def run(rollout, until):
    """Advance to a control step; each decision passes."""
    while rollout.step < until:
        if not rollout.advance():
            assert rollout.correct(said(Kind.PASS)).accepted


def test_a_proposal_that_the_low_level_objects_to_is_skipped_for_the_next_best():
    decisions: list[Decision] = []
    rollout = rollout_of(
        "fly", decisions=decisions, low_level=KnowingLowLevel(knows=["something else"])
    )
    rollout.advance()
    assert decisions[0].proposed[0].goal.text == "fly"
    assert decisions[0].executed.text == "something else"
    assert decisions[0].choice is Choice.OBJECTION
    assert decisions[0].chosen_by == "1.0"


def test_if_the_low_level_objects_to_all_what_was_in_force_stays():
    decisions: list[Decision] = []
    low_level = KnowingLowLevel(knows=["left", "something else"])
    rollout = rollout_of("left", "fly", decisions=decisions, decision_steps=10, low_level=low_level)
    rollout.advance()
    low_level.knows = ["left"]
    while rollout.step < 20:
        rollout.advance()
    assert texts(decisions) == ["left", "left"]
    assert decisions[1].choice is Choice.OBJECTION


def test_a_first_command_that_the_low_level_objects_to_is_better_than_none():
    decisions: list[Decision] = []
    rollout = rollout_of("fly", decisions=decisions, low_level=KnowingLowLevel(knows=[]))
    assert rollout.advance()
    assert decisions[0].executed.text == "fly"
    assert decisions[0].choice is Choice.OBJECTION


def test_what_is_given_back_after_a_word_is_nothing_that_the_low_level_objects_to():
    rollout = rollout_of("fly", low_level=KnowingLowLevel(knows=["something else", "up"]))
    rollout.advance()
    rollout.correct(said(Kind.OVERRIDE, "up"))
    rollout.advance()
    rollout.correct(said(Kind.RELEASE))
    assert rollout.command.text == "something else"


def test_a_word_that_holds_is_told_as_held():
    decisions: list[Decision] = []
    rollout = rollout_of("left", decisions=decisions)
    rollout.advance()
    rollout.correct(said(Kind.OVERRIDE, "up"))
    rollout.advance()
    assert [decision.choice for decision in decisions] == [Choice.BEST, Choice.HELD]
