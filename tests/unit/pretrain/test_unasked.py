"""Prohibitions, complaints and remarks are counted, and hardly any is acted out."""

import pytest

from services.learner.pretrain.unasked import acted_out, unasked
from shared.goals.language.encoder import shared_encoder
from shared.policies import checkpoint
from shared.policies.reader import Reader, restore


@pytest.fixture(scope="module")
def reader() -> Reader:
    return restore(checkpoint.load(checkpoint.bundled("low_level"))[0], shared_encoder())


def test_two_hundred_phrases_ask_for_nothing_and_half_of_them_is_held_out() -> None:
    counts = {one.held_out: len(set(one.phrases)) for one in unasked()}
    assert sum(counts.values()) >= 200
    assert counts[True] >= counts[False]
    shared = set.intersection(*(set(one.phrases) for one in unasked()))
    assert not shared


@pytest.mark.parametrize(("held_out", "share"), [(False, 0.95), (True, 0.85)])
def test_few_of_them_are_acted_out(reader: Reader, held_out: bool, share: float) -> None:
    (phrases,) = [one.phrases for one in unasked() if one.held_out is held_out]
    assert len(acted_out(reader, phrases)) <= (1 - share) * len(phrases)


def test_what_is_an_act_is_told(reader: Reader) -> None:
    said = ("pick up the ham", "wait", "pick up the cup", "I hate ham")
    assert acted_out(reader, said) == ["pick up the ham", "pick up the cup"]
