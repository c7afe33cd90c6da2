"""What is said of the past, kind by kind: what it makes of the labels."""

import random
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from services.learner.labels.account import faults
from services.learner.labels.aggregate import Ground, Label, LabelSettings, derive
from shared.messages.correction import Correction, Kind
from shared.messages.receipt import Receipt
from tests.unit.learner.records import (
    HAM,
    LOW,
    TOAST,
    correction,
    decision,
    episode,
    every_20,
    history_of,
    labels_of,
    receipt,
    ruling,
    texts,
)

LATER = 50
HELD = [correction("c", HAM, decision="e-1-40", seen_step=40), receipt("c", 40)]


def later(id_: str, kind: str, text: str | None = None, **over: Any) -> Correction:
    """Something that was said of the past."""
    return correction(id_, text, **{"kind": kind, "created_ns": LATER, **over})


def relabel(id_: str, text: str, first: int, end: int, **over: Any) -> Correction:
    return later(id_, "relabel", text, first_step=first, end_step=end, **over)


def test_what_was_retracted_labels_and_masks_nothing() -> None:
    said = [*HELD, correction("d", TOAST, decision="e-1-100", seen_step=100), receipt("d", 100)]
    assert texts(labels_of(*every_20(120), *said)) == {40: HAM, 60: HAM, 100: TOAST, 120: TOAST}
    gone = later("r", "retract", target="d")
    # The robot did something else from 100 on, so that the first one is no judgement of it.
    assert texts(labels_of(*every_20(120), *said, gone)) == {40: HAM, 60: HAM, 80: HAM}


def test_of_an_approval_or_a_release_that_was_retracted_nothing_is_left() -> None:
    yes = [correction("a", kind="approve", decision="e-1-20"), receipt("a", 20)]
    assert labels_of(*every_20(60), *yes, later("r", "retract", target="a")) == {}
    free = [correction("f", kind="release", decision="e-1-80"), receipt("f", 80)]
    gone = later("r", "retract", target="f")
    assert texts(labels_of(*every_20(120), *HELD, *free, gone)) == {40: HAM, 60: HAM}


def test_an_edit_is_what_was_said_everywhere() -> None:
    edit = later("e", "edit", TOAST, target="c")
    labels = labels_of(*every_20(60), *HELD, edit)
    assert texts(labels) == {40: TOAST, 60: TOAST}
    assert {label.correction for label in labels.values()} == {"c"}
    again = later("f", "edit", "Wait.", target="c", created_ns=LATER + 1)
    assert set(texts(labels_of(*every_20(60), *HELD, again, edit)).values()) == {"wait"}
    back = later("r", "retract", target="f", created_ns=LATER + 2)
    assert set(texts(labels_of(*every_20(60), *HELD, again, edit, back)).values()) == {TOAST}


def test_a_retime_moves_the_window_and_nothing_before_it_is_masked() -> None:
    first = [correction("b", TOAST), receipt("b", 0)]
    moved = later("t", "retime", target="c", first_step=75, end_step=120)
    labels = labels_of(*every_20(160), *HELD, moved)
    assert texts(labels) == {80: HAM, 100: HAM}
    assert {label.ground for label in labels.values()} == {Ground.HELD}
    labels = labels_of(*every_20(160), *first, *HELD, moved)
    # The robot left the first one at 40, whatever was said about that afterwards.
    assert texts(labels) == {0: TOAST, 20: TOAST, 80: HAM, 100: HAM}


def test_a_word_that_no_robot_obeyed_has_nothing_to_move() -> None:
    moved = later("t", "retime", target="c", first_step=40, end_step=80)
    assert labels_of(*every_20(100), HELD[0], moved) == {}
    assert labels_of(*every_20(100), HELD[0], receipt("c", None), moved) == {}


def test_a_relabel_needs_no_robot_and_labels_each_decision_in_its_steps() -> None:
    labels = labels_of(*every_20(100), relabel("x", HAM, 20, 60))
    assert texts(labels) == {20: HAM, 40: HAM}
    assert {(label.ground, label.weight) for label in labels.values()} == {(Ground.RELABELLED, 1.0)}
    moved = later("t", "retime", target="x", first_step=60, end_step=80)
    reworded = later("e", "edit", TOAST, target="x")
    assert texts(labels_of(*every_20(100), relabel("x", HAM, 20, 60), moved, reworded)) == {
        60: TOAST
    }


def test_a_relabel_stands_over_all_that_was_said_live_before_it() -> None:
    said = [
        *HELD,
        correction("a", kind="approve", decision="e-1-20"),
        receipt("a", 20),
        correction("f", kind="release", decision="e-1-100"),
        receipt("f", 100),
    ]
    labels = labels_of(*every_20(120), *said, relabel("x", TOAST, 0, 120))
    assert set(texts(labels)) == {0, 20, 40, 60, 80, 100}
    assert set(texts(labels).values()) == {TOAST}


def test_only_a_later_relabel_or_override_stands_over_a_relabel() -> None:
    said = [relabel("x", TOAST, 0, 100), relabel("w", HAM, 40, 80, created_ns=LATER + 1)]
    assert texts(labels_of(*every_20(80), *said)) == {0: TOAST, 20: TOAST, 40: HAM, 60: HAM} | {
        80: TOAST
    }
    after = LATER + 9
    live = [
        correction("d", HAM, decision="e-1-60", seen_step=60, created_ns=after, hold_steps=5),
        receipt("d", 60),
        correction("a", kind="approve", decision="e-1-20", created_ns=after),
        receipt("a", 20),
    ]
    found = texts(labels_of(*every_20(80), said[0], *live))
    assert found == {0: TOAST, 20: TOAST, 40: TOAST, 60: HAM, 80: TOAST}


def test_a_slow_high_level_is_relabelled_sooner() -> None:
    labels = labels_of(*every_20(100), relabel("x", HAM, 40, 60), anticipate_steps=20)
    assert texts(labels) == {20: HAM}


@pytest.mark.parametrize(
    "where", [{"first_step": 40, "end_step": 80}, {"decision": "e-1-40"}], ids=["steps", "decision"]
)
def test_a_fault_labels_nothing_and_is_kept_for_the_low_level(where: dict[str, Any]) -> None:
    fault = later("f", "fault", **where)
    said = [*every_20(80), *HELD, fault, relabel("x", TOAST, 40, 60)]
    labels = labels_of(*said)
    (told,) = faults(history_of(*said, episode()))
    blamed = {40, 60} if "end_step" in where else {40}
    assert set(labels) == {40, 60, 80} - blamed
    assert {int(one.rsplit("-", 1)[1]) for one in told.decisions} == blamed
    assert (told.correction, told.robot, told.steps.start) == ("f", "robot-1", 40)
    assert told.steps.stop == (80 if "end_step" in where else 60)
    gone = later("r", "retract", target="f")
    assert set(labels_of(*said, gone)) == {40, 60, 80}
    assert faults(history_of(*said, gone, episode())) == ()


def test_a_fault_that_was_moved_is_about_those_steps() -> None:
    fault = later("f", "fault", decision="e-1-40")
    moved = later("t", "retime", target="f", first_step=60, end_step=80)
    assert set(labels_of(*every_20(80), *HELD, fault, moved)) == {40, 80}


def test_what_a_robot_refused_counts_for_nothing() -> None:
    edit = later("e", "edit", TOAST, target="c")
    assert set(texts(labels_of(*every_20(60), *HELD, edit, receipt("e", None))).values()) == {HAM}
    assert set(texts(labels_of(*every_20(60), *HELD, edit, receipt("e", 45))).values()) == {TOAST}


@pytest.mark.parametrize(
    "amendment",
    [
        later("r", "retract", target="gone"),
        later("r", "retract", target="c", episode="e-2"),
        later("r", "retract", target="c", robot="robot-2"),
        later("e", "edit", TOAST, target="r"),
    ],
    ids=["unknown", "episode", "robot", "kind"],
)
def test_an_amendment_that_fits_no_target_counts_for_nothing(amendment: Correction) -> None:
    free = [correction("r", kind="release", decision="e-1-80"), receipt("r", 80)]
    said = [*every_20(100), *HELD, *(free if amendment.target == "r" else [])]
    assert labels_of(*said, amendment) == labels_of(*said)


def test_a_retraction_is_not_taken_back() -> None:
    said = [*HELD, later("r", "retract", target="c"), later("s", "retract", target="r")]
    assert labels_of(*every_20(60), *said) == {}


ACTS = st.sampled_from([Kind.OVERRIDE, Kind.OVERRIDE, Kind.APPROVE, Kind.RELEASE, Kind.RELABEL])
AMENDS = st.sampled_from([Kind.RETRACT, Kind.EDIT, Kind.RETIME])


@st.composite
def histories(draw: st.DrawFn) -> list[Any]:
    """An episode in which two people talk, take back, reword, move and look back."""
    messages: list[Any] = [*every_20(180), episode()]
    names: list[str] = []
    for number in range(draw(st.integers(1, 10))):
        amends = bool(names) and draw(st.booleans())
        kind = draw(AMENDS if amends else ACTS)
        fields: dict[str, Any] = {"kind": kind, "author": draw(st.sampled_from(["ada", "bob"]))}
        fields["created_ns"] = draw(st.integers(1, 20))
        text = None
        if kind in (Kind.OVERRIDE, Kind.RELABEL, Kind.EDIT):
            text = draw(st.sampled_from([HAM, TOAST, "wait"]))
        if kind in (Kind.RELABEL, Kind.RETIME):
            fields["first_step"] = draw(st.integers(0, 150))
            fields["end_step"] = fields["first_step"] + draw(st.integers(1, 60))
        if amends:
            fields["target"] = draw(st.sampled_from(names))
        elif kind is not Kind.RELABEL:
            named = draw(st.none() | st.integers(0, 9))
            fields["decision"] = None if named is None else f"e-1-{named * 20}"
            fields["seen_step"] = draw(st.none() | st.integers(0, 180))
        if kind is Kind.OVERRIDE:
            fields["hold_steps"] = draw(st.none() | st.integers(1, 80))
        name = f"c-{number}"
        messages.append(correction(name, text, **fields))
        if draw(st.integers(0, 3)):
            step, time_ns = draw(st.integers(0, 180)), draw(st.integers(0, 9))
            messages.append(receipt(name, step, time_ns=time_ns))
        names.append(name)
    if draw(st.booleans()):
        messages.append(ruling("rule-1", verb="alias", phrase=TOAST, means=HAM))
    return messages


def derived(messages: list[Any], **over: Any) -> tuple[Label, ...]:
    return derive(history_of(*messages), LabelSettings(**over), LOW)


@settings(max_examples=200, deadline=None)
@given(histories(), st.sampled_from(["mask", "later"]), st.randoms(use_true_random=False))
def test_the_order_of_arrival_makes_no_difference(
    messages: list[Any], disputed: str, order: random.Random
) -> None:
    before = derived(messages, disputed=disputed)
    order.shuffle(messages)
    assert derived(messages, disputed=disputed) == before


def said_in(messages: list[Any], *kinds: Kind) -> list[Correction]:
    return [one for one in messages if isinstance(one, Correction) and one.kind in kinds]


@settings(max_examples=200, deadline=None)
@given(histories(), st.data())
def test_a_retracted_correction_leaves_no_trace(messages: list[Any], data: st.DataObject) -> None:
    """But that the robot did follow it: what held before goes no further than it did."""
    said = said_in(messages, Kind.OVERRIDE, Kind.APPROVE, Kind.RELABEL, Kind.EDIT, Kind.RETIME)
    gone = data.draw(st.sampled_from(said)) if said else correction("none", HAM)
    kept = [*messages, later("gone", "retract", target=gone.id)]
    never = [
        one
        for one in messages
        if not (isinstance(one, Correction) and gone.id in (one.id, one.target))
    ]
    without = {label.decision: label for label in derived(never, disputed="later")}
    found = {label.decision: label for label in derived(kept, disputed="later")}
    cut = gone.kind is Kind.OVERRIDE and any(
        isinstance(one, Receipt) and one.correction == gone.id for one in messages
    )
    if not cut:
        assert found == without
        return
    assert gone.id not in {label.correction for label in found.values()}
    differ = {id_ for id_ in without if found.get(id_) != without[id_]} | set(found) - set(without)
    grounds = {Ground.HELD, Ground.APPROVED}
    assert {without[id_].ground for id_ in differ if id_ in without} <= grounds
    other = correction(gone.id, "something else", author="eve", decision="e-1-0", seen_step=0)
    changed = [other if one is gone else one for one in kept]
    if gone.hold_steps is None:
        assert derived(changed, disputed="later") == tuple(found.values())


@settings(max_examples=200, deadline=None)
@given(histories(), st.integers(0, 150), st.integers(1, 60), st.data())
def test_a_retimed_correction_labels_its_new_steps_and_no_others(
    messages: list[Any], first: int, length: int, data: st.DataObject
) -> None:
    said = said_in(messages, Kind.OVERRIDE, Kind.RELABEL)
    if not said:
        return
    moved = data.draw(st.sampled_from(said))
    span = {"first_step": first, "end_step": first + length}
    messages.append(later("moved", "retime", target=moved.id, **span))
    steps = {
        int(label.decision.rsplit("-", 1)[1])
        for label in derived(messages, disputed="later")
        if label.correction == moved.id
    }
    assert all(first <= step < first + length for step in steps)
    taken_back = {one.target for one in said_in(messages, Kind.RETRACT)}
    answered = {one.correction for one in messages if isinstance(one, Receipt)}
    obeyed = moved.kind is Kind.RELABEL or moved.id in answered
    if moved.id not in taken_back and obeyed:
        assert steps == {step for step in range(0, 181, 20) if first <= step < first + length}


def test_a_decision_that_nobody_attended_has_no_label_and_its_own_choice_is_never_one() -> None:
    own = [decision(step=step, executed=TOAST, best=TOAST) for step in range(0, 101, 20)]
    labels = labels_of(*own, *HELD, relabel("x", HAM, 0, 20))
    assert texts(labels) == {step: HAM for step in (0, 40, 60, 80, 100)}
