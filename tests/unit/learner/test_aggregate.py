"""The table of labels in the learner's README, case by case."""

import random
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from services.learner.labels.aggregate import Ground, Label, LabelSettings, derive
from services.learner.labels.spell import canonical
from shared.messages.correction import Correction, Kind
from shared.messages.receipt import Receipt
from tests.unit.learner.records import (
    CHEESE,
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
    texts,
)


def test_what_nobody_judged_gives_no_label() -> None:
    assert labels_of(*every_20(100)) == {}


def test_an_override_labels_the_decision_it_was_given_for_and_what_it_holds() -> None:
    given = correction("c", HAM, decision="e-1-40", seen_step=40, hold_steps=30)
    labels = labels_of(*every_20(100), given, receipt("c", 40))
    assert texts(labels) == {40: HAM, 60: HAM}
    assert (labels[40].ground, labels[60].ground) == (Ground.OBJECTED, Ground.HELD)
    assert {label.weight for label in labels.values()} == {1.0}


def test_a_delayed_override_still_labels_the_decision_it_was_given_for() -> None:
    given = correction("c", HAM, decision="e-1-40", delay_steps=35, hold_steps=10)
    assert texts(labels_of(*every_20(100), given, receipt("c", 75))) == {40: HAM, 80: HAM}


def test_an_override_without_an_end_holds_to_the_end_of_its_episode() -> None:
    said = [correction("c", HAM), receipt("c", 50)]
    over = episode(steps=90)
    assert texts(labels_of(*every_20(100), *said, over)) == {60: HAM, 80: HAM}


def test_a_later_override_replaces_the_one_that_held() -> None:
    said = [correction("c", HAM), receipt("c", 40), correction("d", TOAST), receipt("d", 80)]
    labels = labels_of(*every_20(100), *said, before_steps=0)
    assert texts(labels) == {40: HAM, 60: HAM, 80: TOAST, 100: TOAST}


def test_what_held_just_before_an_override_is_masked_unless_it_was_judged() -> None:
    said = [
        correction("c", HAM, decision="e-1-40"),
        receipt("c", 40),
        correction("d", TOAST, decision="e-1-100", seen_step=100),
        receipt("d", 100),
    ]
    labels = labels_of(*every_20(100), *said, before_steps=45)
    assert texts(labels) == {40: HAM, 100: TOAST}  # 60 and 80 lie within 45 steps of 100.
    judged = [correction("a", kind="approve", decision="e-1-80"), receipt("a", 80)]
    labels = labels_of(*every_20(100, executed=HAM), *said, *judged, before_steps=45)
    assert texts(labels) == {40: HAM, 80: HAM, 100: TOAST}


def test_the_mask_begins_before_what_the_person_saw_and_not_before_it_took_effect() -> None:
    said = [
        correction("c", HAM),
        receipt("c", 20),
        correction("d", TOAST, seen_step=60),
        receipt("d", 100),
    ]
    assert texts(labels_of(*every_20(100), *said)) == {20: HAM, 100: TOAST}


def test_by_setting_the_stretch_before_an_override_gets_its_goal_with_less_weight() -> None:
    said = [correction("c", HAM, seen_step=70), receipt("c", 90)]
    labels = labels_of(*every_20(120), *said, before="relabel", before_weight=0.25)
    assert texts(labels) == {60: HAM, 80: HAM, 100: HAM, 120: HAM}
    assert [labels[step].weight for step in (60, 80, 100)] == [0.25, 0.25, 1.0]
    assert labels[60].ground is Ground.BEFORE


def test_of_two_overrides_on_their_way_the_first_to_take_effect_is_the_label() -> None:
    said = [correction("d", TOAST, seen_step=60), receipt("d", 100)]
    said += [correction("c", HAM, seen_step=60), receipt("c", 80)]
    labels = labels_of(*every_20(100), *said, before="relabel")
    assert texts(labels) == {40: HAM, 60: HAM, 80: TOAST, 100: TOAST}


def test_an_override_that_never_took_effect_relabels_nothing() -> None:
    late = correction("c", HAM, seen_step=40, delay_steps=60)
    said = [late, receipt("c", 100, time_ns=1), correction("d", TOAST), receipt("d", 60, time_ns=2)]
    labels = labels_of(*every_20(120), *said, before="relabel", before_steps=0)
    assert HAM not in texts(labels).values()


def test_a_slow_high_level_is_to_say_sooner_what_was_in_force_later() -> None:
    said = [correction("c", HAM, seen_step=60, hold_steps=40), receipt("c", 60)]
    assert texts(labels_of(*every_20(120), *said)) == {60: HAM, 80: HAM}
    assert texts(labels_of(*every_20(120), *said, anticipate_steps=20)) == {40: HAM, 60: HAM}


def test_an_override_that_was_replaced_before_it_began_labels_nothing() -> None:
    said = [
        correction("c", HAM, delay_steps=60),
        receipt("c", 80, time_ns=1),
        correction("d", TOAST),
        receipt("d", 40, time_ns=2),
    ]
    assert set(texts(labels_of(*every_20(100), *said)).values()) == {TOAST}


def test_a_refused_correction_and_one_without_a_receipt_give_no_label() -> None:
    given = correction("c", HAM, decision="e-1-40")
    assert labels_of(*every_20(60), given, receipt("c", None)) == {}
    assert labels_of(*every_20(60), given) == {}


@pytest.mark.parametrize("weight", [0.25, 1.0])
def test_an_approval_labels_its_decision_with_what_was_executed(weight: float) -> None:
    given = correction("a", kind="approve", decision="e-1-20")
    labels = labels_of(*every_20(60), given, receipt("a", 20), approval_weight=weight)
    assert texts(labels) == {20: CHEESE}
    assert (labels[20].weight, labels[20].ground) == (weight, Ground.APPROVED)


def test_an_approval_weight_of_zero_leaves_approvals_out() -> None:
    given = correction("a", kind="approve", decision="e-1-20")
    assert labels_of(*every_20(60), given, receipt("a", 20), approval_weight=0) == {}


def endorsement(first: int = 0, end: int = 200, **over: Any) -> Correction:
    return correction("all", kind="endorse", first_step=first, end_step=end, **over)


def test_an_endorsement_labels_what_the_high_level_chose_where_nobody_spoke() -> None:
    said = [correction("c", HAM, decision="e-1-60", seen_step=60, hold_steps=25), receipt("c", 60)]
    obeyed = [
        decision(step=step, executed=HAM, chosen_by="c") if step == 80 else decision(step=step)
        for step in range(0, 121, 20)
    ]
    labels = labels_of(*obeyed, *said, endorsement(end=120), before_steps=25)
    assert texts(labels) == {0: CHEESE, 20: CHEESE, 60: HAM, 80: HAM, 100: CHEESE}
    assert (labels[0].ground, labels[60].ground) == (Ground.ENDORSED, Ground.OBJECTED)


def test_an_endorsement_says_nothing_of_what_a_retracted_override_chose() -> None:
    said = [correction("c", HAM), receipt("c", 40), correction("r", kind="retract", target="c")]
    obeyed = [
        decision(step=step, executed=HAM, chosen_by="c") if step >= 40 else decision(step=step)
        for step in range(0, 81, 20)
    ]
    assert texts(labels_of(*obeyed, *said, endorsement())) == {0: CHEESE, 20: CHEESE}


def test_an_endorsement_that_was_taken_back_or_weighs_nothing_gives_no_label() -> None:
    back = correction("r", kind="retract", target="all")
    assert labels_of(*every_20(60), endorsement(), back) == {}
    assert labels_of(*every_20(60), endorsement(), approval_weight=0) == {}


def test_what_was_said_of_the_past_stands_against_an_endorsement_and_makes_no_dispute() -> None:
    told = correction("w", HAM, kind="relabel", author="bob", first_step=20, end_step=60)
    labels = labels_of(*every_20(80), endorsement(), told)
    assert texts(labels) == {0: CHEESE, 20: HAM, 40: HAM, 60: CHEESE, 80: CHEESE}


def test_a_slip_of_the_hand_is_not_endorsed() -> None:
    slipped = correction("f", kind="fault", decision="e-1-40")
    assert texts(labels_of(*every_20(60), endorsement(), slipped)).keys() == {0, 20, 60}


@pytest.mark.parametrize("kind", ["pass", "pause", "resume"])
def test_passing_pausing_and_resuming_are_never_labels(kind: str) -> None:
    given = correction("p", kind=kind, decision="e-1-20")
    assert labels_of(*every_20(60), given, receipt("p", 20)) == {}


@pytest.mark.parametrize("approved_ns", [1, 99])
def test_an_approval_never_stands_against_an_override_of_the_same_decision(
    approved_ns: int,
) -> None:
    said = [
        correction("c", HAM, decision="e-1-20", hold_steps=5),
        receipt("c", 20, time_ns=50),
        correction("a", kind="approve", decision="e-1-20"),
        receipt("a", 20, time_ns=approved_ns),
    ]
    assert texts(labels_of(*every_20(60), *said)) == {20: HAM}


def test_a_release_labels_its_decision_with_the_top_proposal_and_ends_the_hold() -> None:
    said = [
        correction("c", HAM),
        receipt("c", 20),
        correction("r", kind="release", decision="e-1-60"),
        receipt("r", 60),
    ]
    held = [decision(step=step, executed=HAM, best=TOAST) for step in range(0, 101, 20)]
    labels = labels_of(*held, *said, approval_weight=0.5)
    assert texts(labels) == {20: HAM, 40: HAM, 60: TOAST}
    assert (labels[60].weight, labels[60].ground) == (0.5, Ground.RELEASED)


def test_a_release_that_names_no_decision_only_ends_the_hold() -> None:
    said = [
        correction("c", HAM),
        receipt("c", 20),
        correction("r", kind="release"),
        receipt("r", 50),
    ]
    assert texts(labels_of(*every_20(100), *said)) == {20: HAM, 40: HAM}


def test_a_release_leaves_what_is_still_on_its_way() -> None:
    said = [
        correction("a", "wait", decision="e-1-0"),
        receipt("a", 0),
        correction("b", HAM, decision="e-1-20", delay_steps=80),
        receipt("b", 100, time_ns=30),
        correction("r", kind="release"),
        receipt("r", 60, time_ns=70),
    ]
    labels = texts(labels_of(*every_20(140), *said, before="keep"))
    assert labels == {0: "wait", 20: HAM, 40: "wait", 100: HAM, 120: HAM, 140: HAM}


def test_who_overrides_a_decision_and_lets_go_has_not_taken_back_that_it_was_wrong() -> None:
    said = [
        correction("a", HAM, decision="e-1-40"),
        receipt("a", 41),
        correction("r", kind="release", decision="e-1-40"),
        receipt("r", 50),
    ]
    assert texts(labels_of(*every_20(80), *said)) == {40: HAM}


def test_an_episode_gives_no_labels_before_it_is_over() -> None:
    given = correction("c", HAM, episode="e-2", decision="e-2-0")
    said = [decision("e-2"), given, receipt("c", 0, episode="e-2")]
    assert labels_of(*said, episode("e-1")) == {}
    assert len(labels_of(*said, episode("e-1"), episode("e-2"))) == 1


def test_an_episode_of_another_low_level_gives_no_labels() -> None:
    said = [*every_20(60), correction("c", HAM), receipt("c", 20)]
    assert labels_of(*said, episode(low_level_sha256="b" * 64)) == {}


@pytest.mark.parametrize(
    ("text", "spelling"),
    [
        ("Pick up  the HAM.", HAM),
        (HAM, HAM),
        ("wait!", "wait"),
        ("...", "..."),
    ],
)
def test_a_phrase_has_one_spelling(text: str, spelling: str) -> None:
    assert canonical(text) == spelling
    assert canonical(canonical(text)) == canonical(text)


KINDS = st.sampled_from([Kind.OVERRIDE, Kind.OVERRIDE, Kind.APPROVE, Kind.RELEASE, Kind.PASS])


@st.composite
def happenings(draw: st.DrawFn) -> list[Any]:
    """Two episodes with some people talking in them."""
    messages: list[Any] = []
    for name in ("e-1", "e-2"):
        messages += [decision(name, step) for step in range(0, 200, 20)]
        messages.append(episode(name))
    for number in range(draw(st.integers(0, 12))):
        name, kind = draw(st.sampled_from(["e-1", "e-2"])), draw(KINDS)
        begin = draw(st.integers(0, 199))
        goal = draw(st.sampled_from([HAM, TOAST])) if kind is Kind.OVERRIDE else None
        named = draw(st.none() | st.integers(0, 9))
        messages.append(
            correction(
                f"c-{number}",
                goal,
                kind=kind,
                episode=name,
                decision=None if named is None else f"{name}-{named * 20}",
                hold_steps=draw(st.none() | st.integers(1, 80)) if goal else None,
            )
        )
        if draw(st.booleans()):
            time_ns = draw(st.integers(0, 5))
            messages.append(receipt(f"c-{number}", begin, episode=name, time_ns=time_ns))
    return messages


def derived(messages: list[Any], **over: Any) -> tuple[Label, ...]:
    return derive(history_of(*messages), LabelSettings(**over), LOW)


@settings(max_examples=150, deadline=None)
@given(happenings(), st.randoms(use_true_random=False))
def test_the_order_of_arrival_makes_no_difference(
    messages: list[Any], order: random.Random
) -> None:
    before = derived(messages)
    order.shuffle(messages)
    assert derived(messages) == before


@settings(max_examples=150, deadline=None)
@given(happenings())
def test_a_decision_has_one_label_at_most_and_only_where_somebody_spoke(
    messages: list[Any],
) -> None:
    labels = derived(messages)
    assert len({label.decision for label in labels}) == len(labels)
    obeyed = {message.correction for message in messages if isinstance(message, Receipt)}
    assert {label.correction for label in labels} <= obeyed


@settings(max_examples=100, deadline=None)
@given(happenings(), st.data())
def test_a_correction_whose_receipt_is_gone_leaves_no_trace(
    messages: list[Any], data: st.DataObject
) -> None:
    said = [message for message in messages if isinstance(message, Correction)]
    if not said:
        return
    gone = data.draw(st.sampled_from(said)).id
    unheard = [one for one in messages if not (isinstance(one, Receipt) and one.correction == gone)]
    never = [one for one in unheard if not (isinstance(one, Correction) and one.id == gone)]
    assert derived(unheard, before="relabel") == derived(never, before="relabel")


@settings(max_examples=100, deadline=None)
@given(happenings(), st.integers(0, 60))
def test_relabelling_adds_to_what_masking_leaves_and_changes_nothing_of_it(
    messages: list[Any], before_steps: int
) -> None:
    some = {label.decision: label for label in derived(messages, before_steps=before_steps)}
    more = derived(messages, before_steps=before_steps, before="relabel")
    assert {label.decision: label for label in more if label.ground is not Ground.BEFORE} == some


@settings(max_examples=100, deadline=None)
@given(happenings())
def test_a_larger_mask_never_adds_a_label_or_changes_one(messages: list[Any]) -> None:
    some = {label.decision: label for label in derived(messages, before_steps=40)}
    more = {label.decision: label for label in derived(messages, before_steps=0)}
    assert some.keys() <= more.keys()
    unjudged = {d for d in some if some[d].ground is Ground.HELD}
    assert all(some[d] == more[d] for d in unjudged)
