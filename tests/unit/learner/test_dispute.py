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
