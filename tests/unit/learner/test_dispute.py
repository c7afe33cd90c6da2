"""Two people who contradict each other, and when they don't."""

from typing import Any

import pytest

from services.learner.labels.aggregate import LabelSettings, disputes
from tests.unit.learner.records import (
    HAM,
    TOAST,
    correction,
    episode,
    every_20,
    history_of,
    labels_of,
    receipt,
    ruling,
    texts,
)


def said(id_: str, text: str | None, author: str, step: int, **over: Any) -> list[Any]:
    """Somebody's word about the decision at `step`, obeyed there."""
    fields = {"author": author, "decision": f"e-1-{step}", "seen_step": step, "hold_steps": 5}
    if text is None:
        fields |= {"hold_steps": None, "kind": "approve"}
    return [correction(id_, text, **fields | over), receipt(id_, step)]


def relabel(id_: str, text: str, author: str, first: int, end: int) -> Any:
    span = {"first_step": first, "end_step": end}
    return correction(id_, text, kind="relabel", author=author, created_ns=9, **span)


ADA = said("a", HAM, "ada", 40)
BOB = said("b", TOAST, "bob", 40)


@pytest.mark.parametrize(
    ("words", "steps"),
    [
        ([*ADA, *BOB], {40}),
        ([*ADA, *said("b", None, "bob", 40)], {40}),
        ([*ADA, relabel("b", TOAST, "bob", 20, 80)], {40}),
        ([relabel("a", HAM, "ada", 0, 60), relabel("b", TOAST, "bob", 40, 100)], {40}),
        ([*said("a", HAM, "ada", 40, hold_steps=45), relabel("b", TOAST, "bob", 60, 90)], {60, 80}),
        ([*ADA, *said("b", HAM, "bob", 40)], set()),
        ([*ADA, *said("b", TOAST, "ada", 40)], set()),
        ([*said("a", HAM, "ada", 40, hold_steps=100), *said("b", TOAST, "bob", 80)], set()),
    ],
    ids=[
        "same decision", "approved", "looked back on", "both looked back", "held", "same words",
        "same person", "one after the other",
    ],
)  # fmt: skip
def test_what_two_people_judge_differently_has_no_label(words: list[Any], steps: set[int]) -> None:
    history = history_of(*every_20(100), *words, episode())
    found = disputes(history, LabelSettings())
    assert {dispute.step for dispute in found} == steps
    assert not steps & set(labels_of(*every_20(100), *words))
    for dispute in found:
        assert {(dispute.one.author, dispute.one.correction)} == {("ada", "a")}
        assert (dispute.other.author, dispute.other.correction) == ("bob", "b")
        assert dispute.one.text != dispute.other.text


def fault(author: str, first: int, end: int) -> Any:
    span = {"first_step": first, "end_step": end}
    return correction("f", kind="fault", author=author, created_ns=9, **span)


LATE = [correction("a", HAM, decision="e-1-40", seen_step=40), receipt("a", 50)]
"""Said about the decision at 40, and obeyed some steps later."""


@pytest.mark.parametrize(
    ("words", "steps"),
    [
        ([*LATE, fault("bob", 40, 50)], {40}),
        ([*LATE, fault("bob", 60, 80)], set()),
        ([*ADA, fault("bob", 40, 50)], set()),
        ([relabel("a", HAM, "ada", 20, 80), fault("bob", 0, 60)], {20, 40}),
        ([*LATE, fault("ada", 40, 50)], set()),
        ([*LATE, *said("b", TOAST, "bob", 40), fault("cem", 80, 90)], {40}),
        ([*ADA, *said("b", TOAST, "bob", 40), fault("cem", 0, 10)], {40}),
    ],
    ids=[
        "the robot still did what one objects to", "the hand slipped at what one said",
        "the robot obeyed at once", "looked back on", "same person", "elsewhere", "of a third",
    ],
)  # fmt: skip
def test_who_blames_the_hand_contradicts_whoever_said_another_command(
    words: list[Any], steps: set[int]
) -> None:
    history = history_of(*every_20(100), *words, episode())
    found = disputes(history, LabelSettings())
    assert {dispute.step for dispute in found} == steps
    assert not steps & set(labels_of(*every_20(100), *words))


def test_blame_is_settled_by_taking_back_either_word() -> None:
    words = [*LATE, fault("bob", 40, 50)]
    assert 40 not in texts(labels_of(*every_20(60), *words))
    back = correction("s", kind="retract", target="f", created_ns=9)
    assert texts(labels_of(*every_20(60), *words, back))[40] == HAM
    back = correction("s", kind="retract", target="a", created_ns=9)
    assert disputes(history_of(*every_20(60), *words, back, episode()), LabelSettings()) == ()


def test_where_the_hand_is_blamed_other_contradictions_are_about_nothing() -> None:
    words = [*ADA, *BOB, fault("cem", 40, 41)]
    found = disputes(history_of(*every_20(60), *words, episode()), LabelSettings())
    assert {one.correction for dispute in found for one in dispute[3:]} <= {"a", "b", "f"}
    assert all("f" in {dispute.one.correction, dispute.other.correction} for dispute in found)


def test_by_setting_the_later_word_counts() -> None:
    assert texts(labels_of(*every_20(60), *ADA, *BOB, disputed="later")) == {40: TOAST}
    yes = said("b", None, "bob", 40)
    assert texts(labels_of(*every_20(60), *ADA, *yes, disputed="later")) == {40: HAM}


@pytest.mark.parametrize(
    ("settlement", "label"),
    [
        (correction("s", kind="retract", target="a", created_ns=9), TOAST),
        (correction("s", HAM, kind="edit", target="b", created_ns=9), HAM),
        (ruling("s", verb="alias", phrase=TOAST, means=HAM), HAM),
    ],
    ids=["retracted", "edited", "alias"],
)
def test_a_dispute_is_settled_by_taking_back_rewording_or_an_alias(
    settlement: Any, label: str
) -> None:
    assert texts(labels_of(*every_20(60), *ADA, *BOB)) == {}
    assert texts(labels_of(*every_20(60), *ADA, *BOB, settlement)) == {40: label}


def test_approvals_that_count_for_nothing_contradict_nobody() -> None:
    words = [*ADA, *said("b", None, "bob", 40)]
    assert texts(labels_of(*every_20(60), *words, approval_weight=0)) == {40: HAM}


def test_an_approval_of_what_the_other_one_said_is_no_dispute() -> None:
    words = [*ADA, *said("b", None, "bob", 40)]
    assert texts(labels_of(*every_20(60, executed=HAM), *words)) == {40: HAM}
