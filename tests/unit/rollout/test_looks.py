"""What the high level is shown of the past, and that decisions say which looks it was."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shared.messages.correction import Kind
from shared.messages.decision import Decision
from shared.rollout.thinking import Beside
from tests.unit.rollout.fakes import SayingHighLevel, rollout_of, said


@pytest.mark.parametrize(
    ("setting", "past"),
    [
        ({}, [(), (0,), (0, 1), (0, 1, 2), (1, 2, 3)]),
        ({"looks": 1}, [()] * 5),
        ({"looks": 3, "look_every": 2}, [(), (), (0,), (1,), (0, 2)]),
    ],
)
def test_earlier_looks_are_spaced_by_decisions_and_fewer_at_first(setting, past):
    decisions: list[Decision] = []
    rollout = rollout_of("left", decisions=decisions, decision_steps=10, **setting)
    while rollout.step < 50:
        rollout.advance()
    assert [decision.past for decision in decisions] == past


@settings(max_examples=50, deadline=None)
@given(
    st.integers(1, 6),
    st.integers(1, 4),
    st.lists(st.integers(0, 100), max_size=6, unique=True),
    st.integers(0, 5),
)
def test_the_pictures_handed_over_are_those_of_the_decisions_that_are_named(
    looks, every, words, latency_steps
):
    decisions: list[Decision] = []
    high_level = SayingHighLevel("left")
    rollout = rollout_of(
        high_level=high_level,
        decisions=decisions,
        decision_steps=10,
        looks=looks,
        look_every=every,
        latency_steps=latency_steps,
    )
    for at in [*sorted(words), 120]:
        while rollout.step < at:
            rollout.advance()
        rollout.correct(said(Kind.OVERRIDE, "up", hold_steps=5))
    seen = {decision.index: decision.arrays["images"] for decision in decisions}
    for decision, past in zip(decisions, high_level.past, strict=False):
        assert len(decision.past) == len(past) < looks
        for index, pictures in zip(decision.past, past, strict=True):
            np.testing.assert_array_equal(pictures, seen[index])
            assert (decision.index - index) % every == 0


def test_a_high_level_beside_the_loop_is_shown_the_past_as_well():
    thinking, high_level = Beside(), SayingHighLevel("left")
    decisions: list[Decision] = []
    rollout = rollout_of(
        high_level=high_level,
        thinking=thinking,
        decisions=decisions,
        decision_steps=1,
        max_steps=100_000,
    )
    while len(decisions) < 5 and not rollout.over:
        rollout.advance()
    thinking.close()
    assert [len(past) for past in high_level.past[:5]] == [0, 1, 2, 3, 3]
    assert [len(decision.past) for decision in decisions[:5]] == [0, 1, 2, 3, 3]
