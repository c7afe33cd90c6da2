"""Reading without a fitted reader: parts, likeness, slips, what is refused."""

import numpy as np
import pytest

from shared.errors import PolicyError
from shared.policies.reader.likeness import FEATURES, Letters, Likeness
from shared.policies.reader.phrase import (
    ACT,
    CONTRAST,
    FILLER,
    PLACE,
    THING,
    Parts,
    take_apart,
    words_of,
)
from shared.policies.reader.reader import restore
from shared.policies.reader.spelling import corrected
from shared.workcell.objects import BODY_NAMES, KITCHEN
from shared.workcell.skills import COMMANDS
from tests.unit.policies import scenes

KITCHEN_ONLY = np.array([name in KITCHEN for name in BODY_NAMES])
EVERYTHING = np.ones(18, np.bool_)


def test_a_phrase_is_taken_apart_into_what_to_do_with_what_and_where() -> None:
    words = words_of("No, not the ham, put THE red mug, please, in the bin!")
    parts = [FILLER, FILLER, CONTRAST, CONTRAST, ACT, THING, THING, THING, FILLER, *[PLACE] * 3]
    apart = take_apart(words, parts)
    assert apart.frame == "put the object to that place"
    assert apart.things == ("red mug",)
    assert apart.places == ("in the bin",)


def test_next_to_and_the_like_belong_to_the_place_that_follows() -> None:
    words = ["put", "it", "next", "to", "the", "plate"]
    apart = take_apart(words, [ACT, ACT, ACT, PLACE, PLACE, PLACE])
    assert (apart.frame, apart.places) == ("put it to that place", ("next to the plate",))
    apart = take_apart(["put", "it", "on", "the", "right"], [ACT, ACT, PLACE, PLACE, ACT])
    assert (apart.frame, apart.places) == ("put it to that place", ("on the right",))
    apart = take_apart(["the", "bread", "can", "you"], [PLACE, THING, ACT, ACT])
    assert (apart.frame, apart.things) == ("the object", ("bread",))
    apart = take_apart(["put", "that", "on", "next"], [ACT] * 4)
    assert apart.frame == "put that on next"


def test_things_told_as_one_are_told_one_by_one_and_pointing_words_are_no_thing() -> None:
    words = words_of("take the cup and the bowl")
    assert take_apart(words, [ACT, *[THING] * 5]).things == ("cup", "bowl")
    assert take_apart(["drop", "that"], [ACT, THING]) == Parts("drop that", (), ())
    assert take_apart([], []) == Parts("", (), ())


@pytest.mark.parametrize(
    ("said", "meant"),
    [
        ("chesee", "cheese"),
        ("cheeese", "cheese"),
        ("chese", "cheese"),
        ("mgu", "mgu"),
        ("x1", "x1"),
    ],
)
def test_a_slip_is_undone_where_a_known_word_is_one_slip_away(said: str, meant: str) -> None:
    assert corrected([said], {"cheese", "mug"}) == [meant]


def test_only_what_is_no_word_is_spelt_anew() -> None:
    reader = scenes.words()
    assert reader.spelt("Take the CHESEE.") == "take the cheese"
    assert reader.spelt("tka chesee!") == "tka cheese"
    assert reader.spelt("  wiat ") == "wait"


def test_letters_are_alike_where_runs_are_shared() -> None:
    alike = Letters(["cup", "teacup", "bowl"]).alike("teacups")
    assert alike[1] > alike[0] > alike[2] == 0.0
    assert Letters(["cup"]).alike("cup") == pytest.approx([1.0])


def test_likeness_is_to_the_nearest_known_texts_of_each_class_and_can_look_away() -> None:
    vectors = np.eye(4, dtype=np.float32)[[0, 1, 2, 3]]
    weights = np.zeros((2, FEATURES + 1), np.float32)
    weights[:, 0] = 1.0
    known = Likeness(["cup", "mug", "bowl", "shoe"], np.array([0, 0, 1, 2]), vectors, weights)
    assert known.logits("mug", vectors[1]).argmax() == 0
    assert known.logits("shoe", vectors[3]).argmax() == 2
    apart = np.array([True, True, False, False])
    assert known.features("mug", vectors[1], apart)[0, 0] == -1.0


@pytest.mark.parametrize("row", range(20))
def test_every_canonical_command_is_read_as_it_is_whatever_lies_there(row: int) -> None:
    reading = scenes.words().read(f"  {COMMANDS[row].upper()}. ", KITCHEN_ONLY)
    assert reading.command == row
    assert reading.scores.shape == (20,)
    assert reading.scores[row] == 1.0


@pytest.mark.parametrize("text", ["do a backflip", "", "?!", "\N{GRINNING FACE}"])
def test_what_means_nothing_is_refused_with_the_nearest_that_is_possible(text: str) -> None:
    reader = scenes.words()
    reading = reader.read(text, KITCHEN_ONLY)
    assert reading.command is None
    near = reader.nearest(text, KITCHEN_ONLY)
    assert len(near) == 3
    assert {text for text, _ in near} <= {
        text for text, can in zip(COMMANDS, reader.possible(KITCHEN_ONLY), strict=True) if can
    }


def test_tensors_make_the_same_reader_again() -> None:
    reader = scenes.words()
    again = restore(reader.tensors(), scenes.Letters())
    assert again.tensors().keys() == reader.tensors().keys()
    for name, value in reader.tensors().items():
        assert np.array_equal(value, again.tensors()[name]), name
    for text in ("put it down", "grab cheese"):
        assert np.array_equal(
            again.read(text, EVERYTHING).scores, reader.read(text, EVERYTHING).scores
        )


def test_other_tensors_hold_no_reader() -> None:
    tensors = scenes.words().tensors()
    short = {name: value for name, value in tensors.items() if name != "reader.names.owners"}
    with pytest.raises(PolicyError, match=r"names\.owners"):
        restore(short, scenes.Letters())
    with pytest.raises(PolicyError, match="hold no reader"):
        restore({**tensors, "reader.parts.extra": np.zeros(1, np.float32)}, scenes.Letters())
