"""What is to be done later is not done now; what only tells how things are is not done at all."""

import numpy as np
import pytest

from shared.policies.reader import asking, clauses, later
from shared.policies.reader.reader import Reader
from shared.workcell.objects import BODY_NAMES, TABLE
from shared.workcell.skills import PUT_DOWN, PUT_IN_BIN, PUT_IN_TUB, WAIT
from tests.unit.policies.reads import read

DISHES = np.array([name in TABLE for name in BODY_NAMES])
BOWL = "pick up the bowl"


@pytest.mark.parametrize(
    "text",
    [
        "pick the bowl up later", "pick up the bowl when I say so", "later, take the bowl",
        "take the bowl in ten minutes", "put it in the tub once I'm ready", "tomorrow, bin the can",
        "when the guests leave, take the bowl", "if I nod put it down", "put it down on my signal",
        "bin it after lunch", "as soon as she calls, put it in the bin",
    ],
)  # fmt: skip
def test_what_is_to_be_done_later_is_refused(reader: Reader, text: str) -> None:
    reading = reader.read(text, DISHES)
    assert (reading.command, reading.why) == (None, later.LATER)


@pytest.mark.parametrize(
    "text",
    [
        "if it's dirty, put it in the tub", "bin it if it's empty", "if the cup is empty take it",
        "put it down if it looks hot", "if there's a bowl, pick it up",
        "if that isn't clean, bin it",
    ],
)  # fmt: skip
def test_what_hangs_on_how_things_are_is_refused(reader: Reader, text: str) -> None:
    reading = reader.read(text, DISHES)
    assert (reading.command, reading.why) == (None, later.HANGS)


@pytest.mark.parametrize(
    "text",
    [
        "take the bowl if it's no trouble", "if that's okay, take the bowl",
        "if it isn't too much bother take the bowl", "if you don't mind take the bowl",
        "unless it's a bother take the bowl", "take the bowl if that is no problem",
        "take the bowl if you can",
        "take the bowl if it's not too much to ask", "if it is possible, take the bowl",
    ],
)  # fmt: skip
def test_an_if_of_courtesy_is_no_condition(reader: Reader, text: str) -> None:
    assert read(reader, text, DISHES) == BOWL


@pytest.mark.parametrize(
    "text",
    [
        "wait until I say to put it down", "hold it until I say and then drop it",
        "don't put it down until I say so", "wait for the bowl", "stay there till I'm back",
        "until I'm back, wait", "do nothing until the guests leave", "keep it till they call",
    ],
)  # fmt: skip
def test_to_wait_until_then_is_to_wait(reader: Reader, text: str) -> None:
    assert read(reader, text, DISHES) == WAIT


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("when you're done take the bowl", BOWL),
        ("take the bowl as soon as you can", BOWL),
        ("take the bowl before it gets cold", BOWL),
        ("after that, put it in the tub", PUT_IN_TUB),
        ("pick up the bowl and hold it until I say", BOWL),
        ("take the bowl, I'll wash it later", BOWL),
    ],
)
def test_courtesy_and_asides_put_nothing_off(reader: Reader, text: str, meant: str) -> None:
    assert read(reader, text, DISHES) == meant


@pytest.mark.parametrize(
    "text",
    [
        "it is in the tub", "it's on the table", "the bin is full", "the tub is very dirty",
        "the bowl is blue", "bowl is blue", "this bowl is clean", "there is a can in the bin",
        "you put it in the tub", "you set it down", "she puts it in the bin", "mind the bowl",
        "be careful with the glass", "look at the can", "watch out for the bowl",
    ],
)  # fmt: skip
def test_what_tells_how_things_are_asks_for_nothing(reader: Reader, text: str) -> None:
    reading = reader.read(text, DISHES)
    assert (reading.command, reading.why) == (None, asking.TELLS)


@pytest.mark.parametrize("text", ["bowl?", "the bowl?", "in the tub?"])
def test_a_name_with_a_question_mark_is_a_question(reader: Reader, text: str) -> None:
    assert reader.read(text, DISHES).why == clauses.ASKS


@pytest.mark.parametrize(
    ("text", "first"),
    [
        ("pick up the bowl and hand it to me", "pick up the bowl"),
        ("take the bowl then pass it to the cook", "take the bowl"),
        ("grab the bowl and rinse it", "grab the bowl"),
        ("put it down and polish it", "put it down"),
    ],
)
def test_a_second_act_that_nobody_can_do_is_refused(reader: Reader, text: str, first: str) -> None:
    assert reader.read(text, DISHES).why == clauses.in_turn(first)


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("the bowl is next", BOWL), ("the bowl is what I want", BOWL), ("the bowl's next", BOWL),
        ("it is for the bin", PUT_IN_BIN), ("it belongs in the tub", PUT_IN_TUB),
        ("the bowl is dirty, take it", BOWL), ("careful with the bowl, take it", BOWL),
        ("would you mind taking the bowl", BOWL), ("how about the bowl?", BOWL),
        ("the bowl, please?", BOWL), ("can you put it in the tub", PUT_IN_TUB),
        ("put it down, the bin is full", PUT_DOWN),
        ("the bin is full, put it in the tub", PUT_IN_TUB),
        ("grab the bowl and be quick about it", BOWL), ("grab the bowl and lift it", BOWL),
    ],
)  # fmt: skip
def test_what_asks_for_something_is_still_done(reader: Reader, text: str, meant: str) -> None:
    assert read(reader, text, DISHES) == meant
