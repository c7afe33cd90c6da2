"""The reader: known phrases, near ones, strange ones."""

import numpy as np
import pytest

from shared.goals.family import Floats
from shared.messages.goal import Goal
from tests.unit.policies.scenes import Letters, words

EVERYTHING = np.ones(18, np.bool_)


class Deaf(Letters):
    """An encoder that may not be asked."""

    def embed(self, goals: tuple[Goal, ...]) -> Floats:
        raise AssertionError(f"asked for {goals}")


@pytest.mark.parametrize(
    "text", ["pick up the cheese", " Grab THE cheese. ", "wait", "put it down!"]
)
def test_a_known_phrase_is_read_without_the_encoder(text: str) -> None:
    reader = words()
    reader._family = Deaf()
    assert reader.read(text, EVERYTHING).command is not None


def test_a_near_phrase_is_read_and_a_far_one_refused() -> None:
    reader = words(threshold=0.9)
    assert reader.read("grab teh cheese", EVERYTHING).command == 0
    assert reader.read("zzz", EVERYTHING).command is None


def test_what_is_not_there_is_not_meant() -> None:
    reader, there = words(threshold=0.1), EVERYTHING.copy()
    there[2] = False
    assert reader.read("grab teh cheese", EVERYTHING).command == 0
    assert reader.read("grab teh cheese", there).command != 0
    scores = reader.read("grab teh cheese", there).scores
    assert "pick up the cheese" not in [text for text, _ in reader.nearest(scores, there)]


def test_what_is_to_be_refused_is_refused_where_it_is_nearest() -> None:
    reader = words(threshold=0.1)
    assert reader.read("wiat", EVERYTHING).command == 3
    reader._owners = reader._owners.copy()
    reader._owners[3] = -1  # To wait is now among what no robot can do.
    reader._seen.clear()
    assert reader.read("wiat", EVERYTHING).command is None
