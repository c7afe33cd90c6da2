"""Which phrase a label has for what was said."""

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from services.learner.labels.spell import canonical, spelling
from shared.messages.ruling import Ruling
from tests.unit.learner.records import CHEESE, HAM, TOAST, correction, every_20, labels_of, receipt
from tests.unit.learner.records import ruling as ruled


def alias(phrase: str, means: str, at_ns: int = 1, verb: str = "alias") -> Ruling:
    return ruled(f"r-{at_ns}", verb=verb, phrase=phrase, means=means, created_ns=at_ns)


@pytest.mark.parametrize(
    ("rulings", "expected"),
    [
        ([], "grab it"),
        ([alias("Grab it.", CHEESE)], CHEESE),
        ([alias("grab it", "take it", 1), alias("take it", CHEESE, 2)], CHEESE),
        ([alias("take it", CHEESE, 1), alias("grab it", "take it", 2)], CHEESE),
        ([alias("grab it", CHEESE, 1), alias("grab it", HAM, 2)], HAM),
        ([alias("grab it", CHEESE, 1), alias(CHEESE, "grab it", 2)], CHEESE),
        ([alias("grab it", CHEESE, 1), alias(CHEESE, "grab it", 2, "distinct")], "grab it"),
        ([alias("grab it", CHEESE, 2), alias("grab it", CHEESE, 1, "distinct")], CHEESE),
        ([alias("grab it", CHEESE, 1), alias("grab it", HAM, 2, "distinct")], CHEESE),
    ],
)
def test_a_phrase_is_what_was_confirmed_last(rulings: list[Ruling], expected: str) -> None:
    for order in itertools.permutations(rulings):
        assert spelling(order)("Grab it!") == expected


NAMES = st.sampled_from(["a", "b", "c", "d"])


@given(st.lists(st.tuples(NAMES, NAMES, st.sampled_from(["alias", "distinct"])), max_size=8))
def test_no_rulings_lead_in_a_ring(told: list[tuple[str, str, str]]) -> None:
    pairs = [(one, other, verb) for one, other, verb in told if one != other]
    spell = spelling(
        alias(one, other, at, verb) for at, (one, other, verb) in enumerate(pairs, start=1)
    )
    for name in "abcd":
        assert spell(spell(name)) == spell(name)


def test_labels_are_in_the_words_that_were_confirmed() -> None:
    said = [correction("c", "Grab the toast!", hold_steps=5), receipt("c", 20)]
    labels = labels_of(*every_20(40), *said, alias("grab the toast", TOAST))
    assert {label.text for label in labels.values()} == {TOAST}
    assert canonical("Grab the toast!") == "grab the toast"
