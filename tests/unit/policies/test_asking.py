"""What only forbids, complains or tells is not acted out; what asks for something still is."""

import numpy as np
import pytest

from shared.policies.reader import asking, clauses
from shared.policies.reader.phrase import ACT, CONTRAST, FILLER, PLACE, THING
from shared.policies.reader.reader import Reader
from shared.workcell.objects import BODY_NAMES, KITCHEN, TABLE
from shared.workcell.skills import PUT_DOWN, PUT_IN_BIN, PUT_ON_PLATE, WAIT
from tests.unit.policies.reads import read

FOOD = np.array([name in KITCHEN for name in BODY_NAMES])
DISHES = np.array([name in TABLE for name in BODY_NAMES])
HAM, CHEESE, CUP = "pick up the ham", "pick up the cheese", "pick up the cup"


@pytest.mark.parametrize(
    "text",
    [
        "it isn't garbage", "I wouldn't bin that", "avoid the plate", "I don't like ham",
        "could you not drop that", "you picked up the ham", "the ham was fine where it was",
        "no ham", "the cheese went on already", "my husband never liked onions",
        "it's a shame you put the toast in the bin", "picking up the ham was a mistake",
        "thank you for picking up the cheese", "why did you bin the bread", "i hate tomato",
        "placing it on the plate is not permitted", "under no circumstances drop it in the bin",
        "the toast fell", "you literally just put that down", "that tomato got squashed",
        "without touching the bowl, please", "it has been placed on the plate",
    ],
)  # fmt: skip
def test_what_asks_for_nothing_is_refused_and_not_proposed(reader: Reader, text: str) -> None:
    for there in (FOOD, DISHES):
        reading = reader.read(text, there)
        assert reading.command is None
        assert reading.why in (asking.TELLS, clauses.FORBIDS, clauses.ASKS)


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("no, pick up the cheese", CHEESE),
        ("no pick up the cheese", CHEESE),
        ("no the cheese", CHEESE),
        ("not the ham, the cheese", CHEESE),
        ("the cheese not the ham", CHEESE),
        ("don't take the ham, take the cheese instead", CHEESE),
        ("I didn't say ham, I said cheese", CHEESE),
        ("I said the ham", HAM),
        ("what I meant was the ham", HAM),
        ("the ham was what I wanted", HAM),
        ("you picked the cheese, the ham was what I wanted", HAM),
        ("the ham fell over pick it up", HAM),
        ("you forgot the ham", HAM),
        ("thank you, pick up the ham", HAM),
        ("if you don't mind, the ham", HAM),
        ("why don't you put it down", PUT_DOWN),
        ("not that, put it back where it was", PUT_DOWN),
        ("I don't want that one, return it to the table", PUT_DOWN),
        ("it's no good any more, bin it", PUT_IN_BIN),
        ("that was the ham, now put it on the plate", PUT_ON_PLATE),
        ("skip the onion and take the cheese", CHEESE),
        ("not like that, away from your hand", PUT_DOWN),
        ("now put it back where you got it", PUT_DOWN),
        ("what you've got there goes in the bin", PUT_IN_BIN),
        ("you were supposed to take the cheese", CHEESE),
        ("I was wondering if you could take the ham", HAM),
        ("wrong one put it down", PUT_DOWN),
        ("not yet", WAIT),
    ],
)
def test_what_asks_for_something_is_read_whatever_it_tells(
    reader: Reader, text: str, meant: str
) -> None:
    assert read(reader, text, FOOD) == meant


def test_a_negation_within_a_description_tells_which_thing(reader: Reader) -> None:
    for text in ("cup without the handle", "the cup without the handle"):
        assert read(reader, text, DISHES) == CUP
    assert read(reader, "the slice nobody has toasted", FOOD) == "pick up the bread"


@pytest.mark.parametrize(
    "text",
    [
        "keep holding it", "no, keep holding it please", "leave it in your hand", "don't let go",
        "don't let go of the ham", "do not release it", "keep hold of it", "hold on to it",
        "keep the ham in your hand", "don't drop it, keep holding it", "leave it in the gripper",
    ],
)  # fmt: skip
def test_to_go_on_holding_is_to_wait(reader: Reader, text: str) -> None:
    assert read(reader, text, FOOD) == WAIT


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("let go", PUT_DOWN),
        ("stop holding it", PUT_DOWN),
        ("don't keep holding it", PUT_DOWN),
        ("pick up the ham and don't let go", HAM),
        ("keep holding it and put it on the plate", PUT_ON_PLATE),
        ("don't keep holding it, put it on the plate", PUT_ON_PLATE),
        ("take hold of the ham", HAM),
    ],
)
def test_what_is_said_besides_holding_counts(reader: Reader, text: str, meant: str) -> None:
    assert read(reader, text, FOOD) == meant


def test_clauses_are_judged_by_words_and_parts() -> None:
    def idle(said: str, parts: list[int]) -> str:
        return clauses.judged(said, parts).idle

    taken = [ACT, THING, THING]
    assert idle("take the ham", taken) == ""
    assert idle("you took the ham", [FILLER, *taken]) == asking.TELLS
    assert idle("could you take the ham", [FILLER, FILLER, *taken]) == ""
    assert idle("could you not take the ham", [FILLER] * 3 + taken) == asking.TELLS
    assert idle("take the ham, not the cheese", [*taken, FILLER, CONTRAST, CONTRAST]) == ""
    assert idle("it fell, bin it", [ACT, ACT, ACT, ACT]) == ""
    assert idle("never there", [FILLER, PLACE]) == asking.TELLS
