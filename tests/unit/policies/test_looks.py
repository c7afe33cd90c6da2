"""A name of kinds and colours fits what is all of that; several are told apart by their sides."""

import numpy as np
import pytest

from shared.goals.language.encoder import shared_encoder
from shared.messages.goal import LanguageGoal
from shared.policies import checkpoint
from shared.policies.low_level import LowLevel
from shared.policies.reader import looks
from shared.policies.reader.located import located
from shared.policies.reader.looks import Fit, alike, fitting
from shared.policies.reader.lying import cover_of, furthest
from shared.policies.reader.phrase import ACT, FILLER, THING
from shared.workcell.objects import BODY_NAMES, HALF_HEIGHTS_M, OBJECT_NAMES, OBJECTS, TABLE, index
from tests.unit.policies.reads import said, scene

DISHES = np.array([name in TABLE for name in BODY_NAMES])


@pytest.fixture(scope="module")
def low_level() -> LowLevel:
    return LowLevel.load(checkpoint.bundled("low_level"), shared_encoder())


def fits(name: str) -> set[str] | None:
    found = fitting(name)
    return None if found is None else {OBJECT_NAMES[row] for row in np.flatnonzero(found)}


def test_a_name_fits_what_is_all_that_it_says() -> None:
    assert fits("red dish") == {"cup"}
    assert fits("red one") == {"tomato", "cup", "can"}
    assert fits("piece of rubbish") == {"can", "wrapper", "carton", "napkin"}
    assert fits("purple dish") == set()
    assert fits("cheese") is None
    assert fits("dish for soup") is None
    assert fits("one") is None


def test_looks_are_those_of_the_things_in_the_cell() -> None:
    assert [name for name, *_ in looks._LOOKS] == list(OBJECT_NAMES)
    for (_, told, kinds), item in zip(looks._LOOKS, OBJECTS, strict=True):
        assert item.kind in kinds.split()
        assert item.name == "bread" or item.colour in told.split()  # Beside toast it is white.


@pytest.mark.parametrize(
    ("text", "side"),
    [
        ("take the dish on the left", "left"), ("the slice on your right", "right"),
        ("the leftmost slice", "left"), ("take the right one", "right"),
        ("the dish furthest left", "left"), ("take the dish with the left hand", ""),
        ("right, take the dish", ""), ("the dish to the left of the bin", ""), ("a dish", ""),
    ],
)  # fmt: skip
def test_a_side_is_said_of_a_thing(text: str, side: str) -> None:
    assert located(text).side == side


@pytest.mark.parametrize(
    ("left", "right"),
    [({"cup": -0.2}, {"saucer": 0.2}), ({"saucer": -0.2}, {"cup": -0.1}),
     ({"glass": 0.1}, {"bowl": 0.3})],
)  # fmt: skip
def test_left_and_right_are_two_things(
    low_level: LowLevel, left: dict[str, float], right: dict[str, float]
) -> None:
    for side, at in (("left", left), ("right", right)):
        taken = f"pick up the {next(iter(at))}"
        assert said(low_level, f"take the dish on the {side}", **left, **right) == (taken, "")


def test_what_fits_several_things_is_refused_with_their_names(low_level: LowLevel) -> None:
    meaning, why = said(low_level, "take the dish", cup=-0.2, saucer=0.2)
    assert meaning == ""
    assert "fits several things: say 'pick up the cup' or 'pick up the saucer'" in why
    assert said(low_level, "take the dish", saucer=0.2) == ("pick up the saucer", "")


def test_a_side_that_tells_nothing_apart_is_refused(low_level: LowLevel) -> None:
    why = said(low_level, "take the dish on the left", cup=-0.2, saucer=-0.195)[1]
    assert "none lies clearly further to the left" in why
    assert said(low_level, "take the dish on the left", cup=-0.2, saucer=-0.2)[0] == ""


def test_colour_and_kind_must_both_hold(low_level: LowLevel) -> None:
    assert said(low_level, "the red dish", cup=0.2, saucer=0.1, can=0.3) == ("pick up the cup", "")
    assert said(low_level, "the red dish", saucer=0.1, can=0.3)[0] == ""
    assert "nothing that is in the scene" in said(low_level, "the red dish", saucer=0.1)[1]
    assert "fits several" in said(low_level, "the red one", cup=0.2, can=0.3)[1]


def test_what_was_taken_by_its_side_stays_meant_wherever_the_hand_goes(low_level: LowLevel) -> None:
    body, objects = scene(cup=-0.2, saucer=0.1)
    goal, cup = LanguageGoal(text="take the dish on the left"), index("cup")
    body[6], body[14:17] = 0.04, (0.3, 0.0, 0.2)
    objects[cup, :3] = body[14:17]  # It is in the left hand now, and lies further right.
    assert np.array_equal(
        low_level.act(body, objects, goal),
        low_level.act(body, objects, LanguageGoal(text="pick up the cup")),
    )
    assert "what is in the hand too" in low_level.objection(body, objects, goal)


def test_things_that_are_as_likely_fit_alike() -> None:
    names = np.zeros(15, np.float32)
    names[[3, 4, 5]] = 0.42, 0.40, 0.12
    assert alike(names, "") == Fit((3, 4), "")
    assert alike(names, "left") == Fit((3, 4, 5), "left")


def test_a_kind_after_an_article_is_a_thing() -> None:
    words = ["take", "the", "dish"]
    assert looks.as_things(words, [ACT] * 3) == [ACT, THING, THING]
    assert looks.as_things(["do", "the", "dishes"], [ACT] * 3) == [ACT] * 3
    assert looks.as_things(words, [ACT, FILLER, FILLER]) == [ACT, FILLER, FILLER]


def test_the_furthest_of_several() -> None:
    objects = np.zeros((18, 9), np.float32)
    objects[:3, 0] = -0.1, 0.0, 0.01
    assert furthest((0, 1, 2), "left", objects) == 0
    assert furthest((0, 1, 2), "right", objects) == 2
    assert furthest((0, 1, 2), "right", objects, 0.02) is None


def test_what_lies_on_a_thing_covers_it_and_what_lies_beside_it_does_not() -> None:
    objects = np.zeros((18, 9), np.float32)
    ham, cheese, toast, cup = map(index, ("ham", "cheese", "toast", "cup"))
    for row, (x, z) in {ham: (0.1, 0.016), cheese: (0.11, 0.032), toast: (0.1, 0.049)}.items():
        objects[row, [0, 2]] = x, z
    objects[cup, [0, 2]] = 0.142, 0.022
    held = np.zeros(15, np.bool_)
    assert cover_of(ham, objects, held, HALF_HEIGHTS_M) == toast
    assert cover_of(toast, objects, held, HALF_HEIGHTS_M) is None
    held[toast] = True
    assert cover_of(ham, objects, held, HALF_HEIGHTS_M) == cheese
