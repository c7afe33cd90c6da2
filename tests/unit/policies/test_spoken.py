"""What is typed in haste or said in dialect is put in standard words; remarks are set apart."""

import pytest

from shared.policies.reader.phrase import ACT, PLACE, THING, plain, take_apart, words_of
from shared.policies.reader.remarks import set_apart
from shared.policies.reader.spoken import unaccented, written


@pytest.mark.parametrize(
    ("said", "plainly"),
    [
        ("tek up t'brittle un", "take up the brittle one"),
        ("get ur mitts on yon bread, pls", "get your hands on that bread, please"),
        ("bit o' pig", "bit of pig"),
        ("hang on a tick", "hang on a moment"),
        ("tomatoooo pick it up", "tomatoo pick it up"),
        ("the wee blasted thingy", "the little thing"),
        ("put it inside of the bin", "put it in the bin"),
        ("pick up the cup", "pick up the cup"),
        ("don't put it down", "don't put it down"),
        ("that's the wee one's", "that's the little one's"),
    ],
)
def test_spoken_words_are_written_as_a_book_has_them(said: str, plainly: str) -> None:
    assert written(said) == plainly


def test_accents_are_dropped() -> None:
    assert unaccented("Consommé") == "Consomme"
    assert plain("  Sauté  it’s") == "saute it's"


@pytest.mark.parametrize(
    ("said", "orders"),
    [
        ("the can rolled off. get it", "get it"),
        ("hmm, too dry still. take the tomato", "take the tomato"),
        ("now we need something fresh, so take the lettuce", "so take the lettuce"),
        ("grab the tomato, as my granny says", "grab the tomato"),
        ("clasp the slice, gently, it squashes easily", "clasp the slice"),
        ("whoa there, cowboy", "whoa there"),
        ("i need the ham", "i need the ham"),
        ("it goes in the bin", "it goes in the bin"),
        ("take the cup, then wash it", "take the cup, then wash it"),
        ("wash the cup, it's dirty", "wash the cup"),
        ("put it down", "put it down"),
    ],
)
def test_remarks_are_no_orders_and_wishes_are(said: str, orders: str) -> None:
    assert set_apart(said).orders == orders


def test_remarks_are_kept_since_they_may_name_what_is_meant() -> None:
    assert set_apart("the can rolled off. get it").remarks == ("the can rolled off",)


def test_the_robots_own_hand_is_no_place_and_the_thing_is_no_name() -> None:
    words = words_of("secure the saucer in your gripper")
    apart = take_apart(words, [ACT, THING, THING, PLACE, PLACE, PLACE])
    assert (apart.places, apart.frame) == ((), "secure the object in your gripper")
    words = words_of("put the item in the bin")
    apart = take_apart(words, [ACT, THING, THING, PLACE, PLACE, PLACE])
    assert (apart.things, apart.frame) == ((), "put the item to that place")


def test_what_a_thing_is_said_to_be_besides_is_no_part_of_its_name() -> None:
    apart = take_apart(words_of("take that poor old cup"), [ACT, THING, THING, THING, THING])
    assert apart.things == ("cup",)
