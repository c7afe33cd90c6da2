"""When a person began to speak, in control steps."""

from typing import Any

import pytest

from services.learner.labels.hear import Word, onset
from services.learner.store.memory import head_of
from shared.messages.decision import Decision
from tests.unit.learner.records import HAM, correction, decision, labels_of, receipt, texts

SECOND = 10**9
START = 5 * SECOND


def at_50_hz(last: int, **over: Any) -> list[Decision]:
    """Decisions every 20 steps, each 0.4 s after the other."""
    steps = range(0, last + 1, 20)
    return [decision(step=step, time_ns=START + step * SECOND // 50, **over) for step in steps]


def onset_of(decisions: list[Decision], begin: int, **said: Any) -> int:
    word = Word(correction("c", HAM, **said), begin, begin, True)
    return onset(word, [head_of(one) for one in decisions], 50.0)


@pytest.mark.parametrize(
    ("after_ns", "seen_step", "expected"),
    [
        (1_300_000_000, 100, 65),  # They began 65 steps after the start, and sent it at 100.
        (1_300_000_000, 40, 40),  # What they say they saw was earlier still.
        (9 * SECOND, 100, 100),  # Long after the last decision: no later than what they saw.
        (-SECOND, 80, 80),  # Before anything was decided: the clocks tell nothing.
    ],
)
def test_in_real_time_a_person_began_when_their_clock_says_or_saw_it_sooner(
    after_ns: int, seen_step: int, expected: int
) -> None:
    begun = {"begun_ns": START + after_ns, "seen_step": seen_step}
    assert onset_of(at_50_hz(200), 110, **begun) == expected


def test_without_a_step_that_was_seen_the_clock_alone_tells_it() -> None:
    assert onset_of(at_50_hz(200), 110, begun_ns=START + 1_300_000_000) == 65


def test_without_times_the_step_that_was_seen_alone_tells_it() -> None:
    heads = [head_of(one)._replace(time_ns=None) for one in at_50_hz(200)]
    said = correction("c", HAM, begun_ns=START + 1_300_000_000, seen_step=100)
    assert onset(Word(said, 110, 1, True), heads, 50.0) == 100


def test_a_robot_that_stood_still_did_not_go_beyond_its_next_decision() -> None:
    slow = [decision(step=step, time_ns=START + step * SECOND) for step in (0, 20, 40)]
    assert onset_of(slow, 40, begun_ns=START + 39 * SECOND, seen_step=40) == 40
    assert onset_of(slow, 40, begun_ns=START + 19 * SECOND, seen_step=40) == 20


@pytest.mark.parametrize("delay_steps", [0, 30])
def test_while_a_robot_waits_for_a_verdict_no_step_passes(delay_steps: int) -> None:
    """The oracle's case: the decision waits at 40 for seconds, and is obeyed at once or later."""
    waiting = [decision(step=step, time_ns=START + step * SECOND) for step in (0, 20, 40, 60)]
    begun = {"begun_ns": START + 45 * SECOND, "delay_steps": delay_steps}
    named = onset_of(waiting, 40 + delay_steps, **begun, seen_step=40)
    blind = onset_of(waiting, 40 + delay_steps, **begun)
    assert named == 40
    assert min(blind, 40 + delay_steps) == 40


def test_the_mask_reaches_back_from_when_the_person_began_by_their_reaction_time() -> None:
    said = [
        correction("b", "wait"),
        receipt("b", 0),
        correction("c", HAM, begun_ns=START + 1_300_000_000, seen_step=100),
        receipt("c", 110),
    ]
    labels = labels_of(*at_50_hz(160), *said, before_steps=20)
    # 65 - 20 = 45: the decisions at 60, 80 and 100 may have been wrong already.
    assert texts(labels) == {0: "wait", 20: "wait", 40: "wait", 120: HAM, 140: HAM, 160: HAM}
