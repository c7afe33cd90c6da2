"""When the high level is asked again, and that each decision says why."""

from collections import Counter
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shared.messages.correction import Kind
from shared.messages.decision import Asked, Decision
from shared.rollout.settings import RolloutSettings
from shared.rollout.thinking import Lockstep
from tests.unit.rollout.fakes import CountingRobot, KnowingLowLevel, rollout_of, said


def asked(*commands, steps=100, low_level=None, words=(), **settings):
    """(step, why) of each decision of a rollout; `words` are (step, correction)."""
    decisions: list[Decision] = []
    rollout = rollout_of(*commands, low_level=low_level, decisions=decisions, **settings)
    words = dict(words)
    while rollout.step < steps:
        if rollout.step in words:
            assert rollout.correct(words.pop(rollout.step)).accepted
        assert rollout.advance()
    assert rollout.asked == Counter(decision.asked for decision in decisions)
    return [(decision.step, decision.asked) for decision in decisions]


def reached(at, text="left"):
    """A command that is achieved from control step `at` on; no other ever is."""
    return KnowingLowLevel(lambda step, said: float(step >= at and said == text))


def test_by_interval_the_classifier_is_never_asked():
    low_level = reached(0)
    found = asked("left", low_level=low_level, decision_steps=40)
    assert found == [(0, Asked.START), (40, Asked.INTERVAL), (80, Asked.INTERVAL)]
    assert low_level.asked == []


def test_completion_asks_at_once_and_the_next_command_begins_at_the_same_step():
    robot = CountingRobot()
    decisions: list[Decision] = []
    rollout = rollout_of(
        "left",
        "rightward",
        robot=robot,
        low_level=reached(30),
        decisions=decisions,
        replan="completion",
        execute_steps=5,
    )
    for _ in range(60):
        rollout.advance()
    assert [(decision.step, decision.asked) for decision in decisions] == [
        (0, Asked.START),
        (30, Asked.COMPLETION),
    ]
    assert [int(action[0]) for action in robot.actions] == [4] * 30 + [9] * 30


def test_the_classifier_is_looked_at_only_where_a_chunk_is_fetched():
    low_level = KnowingLowLevel()
    asked("left", low_level=low_level, replan="completion", execute_steps=7, steps=50)
    assert low_level.asked == [7, 14, 21, 28, 35, 42, 49]
    low_level = KnowingLowLevel()
    asked(
        "left",
        low_level=low_level,
        replan="completion",
        execute_steps=5,
        completion_check_steps=12,
        steps=50,
    )
    assert low_level.asked == [15, 30, 45]


def test_what_is_less_probable_than_the_threshold_is_not_achieved():
    low_level = KnowingLowLevel(lambda step, _: step / 100)
    found = asked(
        "left", "up", low_level=low_level, replan="completion", completion_threshold=0.6, steps=80
    )
    assert found[1] == (60, Asked.COMPLETION)


def test_a_classifier_that_never_fires_stalls_a_robot_that_asks_by_completion_alone():
    assert asked("left", "up", replan="completion", steps=500) == [(0, Asked.START)]


def test_a_classifier_that_never_fires_ends_in_the_stuck_timer():
    found = asked("left", "left", "up", replan="completion", stuck_steps=90, steps=300)
    assert found == [(0, Asked.START), (90, Asked.STUCK), (180, Asked.STUCK), (270, Asked.STUCK)]
    found = asked("left", replan="both", decision_steps=100, stuck_steps=150, steps=310)
    assert found == [
        (0, Asked.START),
        (100, Asked.INTERVAL),
        (150, Asked.STUCK),
        (250, Asked.INTERVAL),
        (300, Asked.STUCK),
    ]


def test_by_both_the_stuck_timer_runs_unless_it_is_switched_off():
    assert RolloutSettings(replan="both").patience_steps == 150
    assert RolloutSettings(replan="both", stuck_steps=0).patience_steps == 0
    assert RolloutSettings(replan="completion").patience_steps == 0
    assert RolloutSettings().patience_steps == 0


def test_another_command_gets_a_stuck_timer_of_its_own():
    word = said(Kind.OVERRIDE, "up")
    found = asked("left", replan="completion", stuck_steps=50, steps=100, words=[(30, word)])
    assert found == [(0, Asked.START), (30, Asked.INTERJECTION), (80, Asked.STUCK)]


def test_a_command_that_stays_achieved_is_asked_about_again_but_not_at_each_look():
    found = asked("left", low_level=reached(30), replan="completion", decision_steps=20, steps=80)
    assert found == [
        (0, Asked.START),
        (30, Asked.COMPLETION),
        (50, Asked.COMPLETION),
        (70, Asked.COMPLETION),
    ]


def test_a_persons_word_holds_over_its_own_completion():
    word = said(Kind.OVERRIDE, "up")
    decisions: list[Decision] = []
    rollout = rollout_of(
        "left", low_level=reached(20, "up"), decisions=decisions, replan="both", decision_steps=50
    )
    rollout.advance()
    rollout.correct(word)
    for _ in range(60):
        rollout.advance()
    whys = [(decision.asked, decision.chosen_by) for decision in decisions[1:]]
    assert whys == [(Asked.INTERJECTION, word.id), (Asked.COMPLETION, word.id)]
    assert rollout.command.text == "up"


def test_words_and_their_ends_say_that_they_were_the_reason():
    words = [(10, said(Kind.OVERRIDE, "up", hold_steps=15)), (40, said(Kind.OVERRIDE, "down"))]
    words.append((50, said(Kind.RELEASE)))
    assert asked("left", words=words, decision_steps=100, steps=60) == [
        (0, Asked.START),
        (10, Asked.INTERJECTION),
        (25, Asked.EXPIRY),
        (40, Asked.INTERJECTION),
        (50, Asked.INTERJECTION),
    ]


def test_a_completion_of_what_is_no_longer_in_force_asks_nobody():
    """It is achieved while the high level thinks; its answer brings another command."""
    found = asked(
        "left",
        "rightward",
        low_level=reached(45),
        thinking=Lockstep(latency_steps=10),
        latency_steps=10,
        replan="both",
        decision_steps=40,
        steps=75,
    )
    assert found == [(0, Asked.START), (40, Asked.INTERVAL)]


@pytest.mark.parametrize("text", ["left", "up"])
def test_what_is_achieved_while_the_high_level_thinks_is_asked_about_next(text):
    found = asked(
        "left",
        low_level=reached(45, text),
        thinking=Lockstep(latency_steps=10),
        latency_steps=10,
        replan="both",
        decision_steps=40,
        steps=75,
    )
    after = [(51, Asked.COMPLETION)] if text == "left" else []
    assert found == [(0, Asked.START), (40, Asked.INTERVAL), *after]


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from(["interval", "both"]),
    st.integers(1, 40),
    st.integers(0, 60),
    st.integers(0, 12),
    st.sets(st.integers(0, 200)),
)
def test_no_time_longer_than_the_interval_passes_without_a_question(
    replan, decision_steps, stuck_steps, execute_steps, achieved
):
    """Whatever the classifier says; except by completion alone."""
    found = asked(
        "left",
        low_level=KnowingLowLevel(lambda step, _: float(step in achieved)),
        replan=replan,
        decision_steps=decision_steps,
        stuck_steps=stuck_steps,
        execute_steps=execute_steps + 1,
        steps=200,
    )
    steps = [step for step, _ in found]
    assert max(b - a for a, b in pairwise([*steps, 200])) <= decision_steps
    if replan == "interval" and not stuck_steps:
        assert {why for _, why in found[1:]} <= {Asked.INTERVAL}


@settings(max_examples=60, deadline=None)
@given(st.integers(1, 80), st.sets(st.integers(0, 300)), st.sampled_from(["completion", "both"]))
def test_no_command_outlasts_the_stuck_timer_without_a_question(stuck_steps, achieved, replan):
    low_level = KnowingLowLevel(lambda step, _: float(step in achieved))
    found = asked("left", low_level=low_level, replan=replan, stuck_steps=stuck_steps, steps=300)
    quiet = [step for step, why in found if why in (Asked.START, Asked.STUCK)]
    quiet += [step for step in low_level.asked if step in achieved]
    ends = [*sorted(quiet), 300]
    assert max(b - a for a, b in pairwise(ends)) <= stuck_steps
