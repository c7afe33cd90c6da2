"""Prohibitions, complaints and remarks are counted, and hardly any is acted out."""

import pytest

from services.learner.pretrain.unasked import acted_out, unasked
from shared.goals.language.encoder import shared_encoder
from shared.policies import checkpoint
from shared.policies.reader.reader import Reader, restore


@pytest.fixture(scope="module")
def reader() -> Reader:
    return restore(checkpoint.load(checkpoint.bundled("low_level"))[0], shared_encoder())


def test_many_phrases_ask_for_nothing_and_most_of_them_are_held_out() -> None:
    counts = {one.name: len(set(one.phrases)) for one in unasked()}
    assert all(count >= 120 for count in counts.values())
    assert [one.name for one in unasked() if not one.held_out] == ["a"]
    shared = set.intersection(*(set(one.phrases) for one in unasked()))
    assert not shared


@pytest.mark.parametrize(("name", "share"), [("a", 0.95), ("b", 0.85), ("c", 0.7)])
def test_few_of_them_are_acted_out(reader: Reader, name: str, share: float) -> None:
    (phrases,) = [one.phrases for one in unasked() if one.name == name]
    assert len(acted_out(reader, phrases)) <= (1 - share) * len(phrases)


def test_what_is_an_act_is_told(reader: Reader) -> None:
    said = ("pick up the ham", "wait", "pick up the cup", "I hate ham")
    assert acted_out(reader, said) == ["pick up the ham", "pick up the cup"]
