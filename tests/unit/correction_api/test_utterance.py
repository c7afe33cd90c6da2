"""What a client may say, and what it is told when it says something else."""

import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from services.correction_api.utterance import FORBIDDEN, JOINERS, Utterance, check_words
from shared.messages.correction import Kind
from shared.messages.message import MAX_TEXT


@given(st.text(max_size=MAX_TEXT + 20))
def test_words_are_clean_or_refused(text: str) -> None:
    try:
        words = check_words(text)
    except ValueError:
        return
    assert words == unicodedata.normalize("NFC", text.strip())
    assert 1 <= len(words) <= MAX_TEXT
    assert (
        not {unicodedata.category(letter) for letter in words if letter not in JOINERS} & FORBIDDEN
    )


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("", "it was empty"),
        (" \t ", "it was empty"),
        ("a" * 201, "201 characters are too many; at most 200"),
        ("pick\nup", "U+000A at character 4"),
        ("pick\u202eup", "U+202E at character 4"),
        ("\ud800", "U+D800 at character 0"),
    ],
)
def test_refused_words_say_what_would_be_right(text: str, hint: str) -> None:
    with pytest.raises(ValueError, match=hint.replace("+", r"\+")):
        check_words(text)


@pytest.mark.parametrize(
    "body",
    [
        {"kind": "override"},
        {"kind": "release", "text": "wait"},
        {"kind": "pause", "hold_steps": 5},
        {"kind": "approve"},
        {"kind": "pass"},
        {"kind": "override", "text": "wait", "begun_ns": 2**63},
        {"kind": "override", "text": "wait", "author": "Anna"},
        {"kind": "override", "text": "wait", "colour": "red"},
        {"kind": "override", "text": "wait", "hold_steps": "5"},
        {"kind": "override", "text": "wait", "hold_steps": True},
        {"kind": "pause", "seen_step": "5"},
        {"kind": "pause", "begun_ns": True},
        {"kind": "pause", "delay_steps": 1.0},
    ],
)
def test_what_makes_no_sense_is_refused(body: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        Utterance.model_validate(body)


def test_a_correction_keeps_the_three_times() -> None:
    said = Utterance(kind=Kind.OVERRIDE, text="wait", begun_ns=5, decision="d-1")
    correction = said.formulate("c-1", "robot-1", "e-1", seen_step=40, now_ns=9)
    assert (correction.seen_step, correction.begun_ns, correction.created_ns) == (40, 5, 9)
    assert correction.goal is not None
    assert correction.goal.text == "wait"
    assert correction.hold_steps is None


def test_a_digest_tells_what_was_said_and_about_whom() -> None:
    said = Utterance(kind=Kind.OVERRIDE, text="wait", id="a")
    assert said.digest("robot-1") == said.model_copy(update={"id": "b"}).digest("robot-1")
    assert said.digest("robot-1") != said.digest("robot-2")
    assert said.digest("robot-1") != said.model_copy(update={"text": "stop"}).digest("robot-1")
