"""What each message refuses, and what it promises."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from shared.errors import MessageError
from shared.messages.correction import (
    AFTERWARDS,
    ALLOWS,
    AMENDMENTS,
    BOUND,
    NEEDS,
    Correction,
    Kind,
)
from shared.messages.decision import Decision, Proposal, entropy
from shared.messages.episode import Episode
from shared.messages.frame import Frame
from shared.messages.goal import LanguageGoal
from shared.messages.message import ID_PATTERN, MAX_TEXT, new_id
from shared.messages.observation import Observation
from shared.messages.policy import PolicyAnnouncement, TensorRef, Version
from shared.messages.receipt import Receipt
from shared.wire.codec import decode
from tests.contract.samples import arrays, golden_file, samples

SAMPLES = samples()


def changed(cls, **fields):
    """The sample of a class with other fields, checked anew."""
    sample = SAMPLES[cls]
    return cls.model_validate(sample.model_dump() | {"arrays": sample.arrays} | fields)


@pytest.mark.parametrize("cls", SAMPLES, ids=lambda cls: cls.__name__)
def test_a_message_refuses_a_field_that_it_does_not_know(cls):
    with pytest.raises(ValidationError, match="surprise"):
        changed(cls, surprise=1)


@pytest.mark.parametrize("cls", SAMPLES, ids=lambda cls: cls.__name__)
def test_a_message_never_changes(cls):
    with pytest.raises(ValidationError, match="frozen"):
        SAMPLES[cls].time_ns = 0


@pytest.mark.parametrize("cls", SAMPLES, ids=lambda cls: cls.__name__)
def test_the_head_in_json_names_no_arrays(cls):
    assert "arrays" not in SAMPLES[cls].without_arrays()
    assert "arrays" not in cls.model_json_schema().get("required", [])


@pytest.mark.parametrize("id", ["", "A", "a/b", "a*", "a\n", "ä", "a" * 65, "a b", "$", "../a"])
def test_an_id_is_safe_in_a_key_a_path_and_a_url(id):
    with pytest.raises(ValidationError):
        changed(Receipt, robot=id)


@given(st.text(alphabet="abcdefghijklmnopqrstuvwxyz-", max_size=40))
def test_a_fresh_id_is_an_id_and_never_the_same(prefix):
    one, two = new_id(prefix), new_id(prefix)
    assert ID_PATTERN.fullmatch(one)
    assert one != two


@pytest.mark.parametrize("text", ["", "   ", "\n", "x" * (MAX_TEXT + 1)])
def test_a_command_says_something_and_not_too_much(text):
    with pytest.raises(ValidationError):
        LanguageGoal(text=text)


def test_a_command_loses_the_blanks_around_it():
    assert LanguageGoal(text="  wait \n") == LanguageGoal(text="wait")


SPAN = {"first_step": 10, "end_step": 20}
FITS: dict[Kind, dict[str, object]] = {
    Kind.OVERRIDE: {"goal": LanguageGoal(text="wait"), "hold_steps": 5, "decision": "dec-1"},
    **{kind: {"decision": "dec-1"} for kind in (Kind.APPROVE, Kind.RELEASE, Kind.PASS)},
    **{kind: {} for kind in (Kind.PAUSE, Kind.RESUME)},
    Kind.RETRACT: {"target": "cor-0"},
    Kind.EDIT: {"target": "cor-0", "goal": LanguageGoal(text="wait")},
    Kind.RETIME: {"target": "cor-0", **SPAN},
    Kind.RELABEL: {"goal": LanguageGoal(text="wait"), **SPAN},
    Kind.FAULT: {"decision": "dec-1"},
    Kind.ENDORSE: SPAN,
}
NO_FIELDS = dict.fromkeys(BOUND)


@pytest.mark.parametrize("kind", Kind)
def test_each_kind_of_correction_has_the_fields_that_it_needs_and_no_others(kind):
    fits = FITS[kind]
    changed(Correction, kind=kind, **(NO_FIELDS | fits))
    for name in NEEDS.get(kind, ()):
        with pytest.raises(ValidationError, match=f"{kind} needs .*{name}"):
            changed(Correction, kind=kind, **(NO_FIELDS | fits | {name: None}))
    for name in set(BOUND) - NEEDS.get(kind, set()) - ALLOWS.get(kind, set()):
        value = {"goal": LanguageGoal(text="wait"), "target": "cor-0", "decision": "dec-1"}
        with pytest.raises(ValidationError, match=f"{kind} has no .*{name}.*; it has"):
            changed(Correction, kind=kind, **(NO_FIELDS | fits | {name: value.get(name, 15)}))


@pytest.mark.parametrize(
    ("fields", "why"),
    [
        ({"first_step": 10}, "go together"),
        ({"first_step": 10, "end_step": 10}, "more than 10"),
        ({}, "a fault needs decision, or first_step and end_step"),
    ],
)
def test_a_stretch_has_two_ends_and_a_step_between_them(fields, why):
    with pytest.raises(ValidationError, match=why):
        changed(Correction, kind=Kind.FAULT, **(NO_FIELDS | fields))


def test_what_is_said_about_a_correction_is_said_afterwards():
    assert AMENDMENTS < AFTERWARDS
    assert {kind for kind in Kind if "target" in NEEDS.get(kind, ())} == AMENDMENTS
    assert changed(Correction).span == range(140, 240)


@pytest.mark.parametrize("fields", [{"hold_steps": 0}, {"delay_steps": -1}, {"begun_ns": -1}])
def test_times_and_steps_are_never_negative(fields):
    with pytest.raises(ValidationError):
        changed(Correction, **fields)


def test_proposals_stand_best_first():
    worse, better = (Proposal(goal=LanguageGoal(text="wait"), score=s) for s in (0.25, 0.75))
    changed(Decision, proposed=(better, worse))
    with pytest.raises(ValidationError, match="best first"):
        changed(Decision, proposed=(worse, better))
    with pytest.raises(ValidationError):
        changed(Decision, proposed=())


@pytest.mark.parametrize("past", [(3,), (0, 5), (1, 0), (1, 1)])
def test_what_was_shown_of_the_past_is_earlier_and_oldest_first(past):
    changed(Decision, past=(0, 2))
    with pytest.raises(ValidationError, match="oldest first"):
        changed(Decision, past=past)


def test_a_decision_of_before_has_no_reasons_and_no_past():
    old = decode(Decision, golden_file(Decision, 1).read_bytes())
    assert (old.asked, old.choice, old.past) == (None, None, ())
    assert decode(Episode, golden_file(Episode, 1).read_bytes()).asked == {}


def scored(*scores):
    return tuple(
        Proposal(goal=LanguageGoal(text=f"go {i}"), score=score) for i, score in enumerate(scores)
    )


def test_entropy_is_nothing_where_all_is_sure_and_most_where_nothing_is():
    assert entropy(scored(1.0)) == entropy(scored(1.0, 0.0)) == 0.0
    assert entropy(scored(*[0.125] * 8)) == pytest.approx(math.log(8))
    assert SAMPLES[Decision].entropy == pytest.approx(0.5623, abs=1e-4)


@given(st.lists(st.floats(0.001, 1), min_size=2, max_size=20), st.integers(1, 20))
def test_entropy_of_the_first_proposals_is_never_more_than_that_of_all(weights, top):
    shares = sorted((weight / sum(weights) for weight in weights), reverse=True)
    whole = -sum(share * math.log(share) for share in shares)
    assert entropy(scored(*shares)) == pytest.approx(whole, abs=1e-6)
    assert -1e-9 <= entropy(scored(*shares[:top])) <= whole + 1e-6


@pytest.mark.parametrize("score", [-0.1, 1.1, float("nan"), float("inf")])
def test_a_score_is_a_probability(score):
    with pytest.raises(ValidationError):
        Proposal(goal=LanguageGoal(text="wait"), score=score)


def test_a_receipt_has_a_step_or_a_reason():
    changed(Receipt, accepted=False, step=None, reason="the episode is over")
    for fields in ({"step": None}, {"accepted": False}, {"accepted": False, "step": None}):
        with pytest.raises(ValidationError):
            changed(Receipt, **fields)


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"images": None}, "carries arrays"),
        ({"depth": np.zeros(3, np.float32)}, "carries arrays"),
        ({"proprioception": np.zeros(22)}, "float64"),
        ({"proprioception": np.zeros((22, 1), np.float32)}, r"\[22, 1\]"),
        ({"proprioception": np.zeros(257, np.float32)}, r"\[257\]"),
        ({"images": np.zeros((2, 64, 64, 4), np.uint8)}, r"\[2, 64, 64, 4\]"),
        ({"images": np.zeros((9, 64, 64, 3), np.uint8)}, r"\[9, 64, 64, 3\]"),
    ],
)
def test_arrays_are_those_that_the_message_declares(wrong, says):
    given = {name: array for name, array in (arrays() | wrong).items() if array is not None}
    with pytest.raises(MessageError, match=says):
        Observation(step=0, prompt="a sandwich", arrays=given)


def test_a_message_with_arrays_is_none_without_them():
    with pytest.raises(MessageError, match="jpeg"):
        changed(Frame, arrays={})


versions = st.builds(Version, st.integers(0, 10**6), st.integers(0, 10**6))


@given(versions)
def test_a_version_reads_back_what_it_writes(version):
    assert Version.parse(str(version)) == version
    assert hash(Version.parse(str(version))) == hash(version)


@given(versions, versions)
def test_a_learner_of_a_lower_epoch_is_older_in_everything(one, two):
    assert (one < two) == ((one.epoch, one.number) < (two.epoch, two.number))


@pytest.mark.parametrize(
    "text", ["", "1", "1.", ".1", "1.2.3", "-1.0", "1.x", "v1.0", " 1.0", "1.0\n"]
)
def test_a_version_is_two_whole_numbers(text):
    with pytest.raises(ValueError, match=r"such as 1\.0"):
        Version.parse(text)


def test_a_version_in_a_message_travels_as_text():
    assert SAMPLES[Decision].without_arrays()["version"] == "1.2"
    with pytest.raises(ValidationError, match=r"EPOCH\.NUMBER"):
        changed(Decision, version="1")


@pytest.mark.parametrize(
    "fields", [{"sha256": "AB" * 32}, {"sha256": "ab"}, {"size_bytes": -1}, {"size_bytes": 2**31}]
)
def test_a_tensor_is_named_by_a_hash_and_has_a_size_within_reason(fields):
    ref = SAMPLES[PolicyAnnouncement].tensors[0]
    with pytest.raises(ValidationError):
        TensorRef.model_validate(ref.model_dump() | fields)
