"""What a phrase claims must be true: colours, materials, and that a thing lies where it is put."""

import numpy as np
import pytest

from shared.goals.language.encoder import shared_encoder
from shared.messages.goal import LanguageGoal
from shared.policies import checkpoint
from shared.policies.low_level import LowLevel
from shared.policies.reader import claims
from shared.policies.reader.lying import place_of
from shared.workcell.objects import BIN, OBJECTS, PLATE, index
from tests.unit.policies.reads import said
from tests.unit.policies.scenes import gripping

TAKE = {"glass": "pick up the glass", "carton": "pick up the carton"}


@pytest.fixture(scope="module")
def low_level() -> LowLevel:
    return LowLevel.load(checkpoint.bundled("low_level"), shared_encoder())


@pytest.mark.parametrize(
    "text",
    ["the red glass", "pick up the black glass", "a white glass", "the glass that is blue",
     "take the wooden carton", "the green carton", "the little pink carton"],
)  # fmt: skip
def test_a_false_colour_or_material_is_refused_with_the_true_one(
    low_level: LowLevel, text: str
) -> None:
    name = "glass" if "glass" in text else "carton"
    meaning, why = said(low_level, text, glass=-0.2, carton=0.2)
    assert meaning == ""
    own = "green" if name == "glass" else "blue"
    assert f"the {name} is {own}: if it is meant, say {TAKE[name]!r}" in why


@pytest.mark.parametrize(
    ("text", "name"),
    [("the green glass", "glass"), ("the glass", "glass"), ("the blue carton", "carton"),
     ("the cardboard carton", "carton"), ("the glass that isn't red", "glass")],
)  # fmt: skip
def test_true_claims_are_fine(low_level: LowLevel, text: str, name: str) -> None:
    assert said(low_level, text, glass=-0.2, carton=0.2) == (TAKE[name], "")


@pytest.mark.parametrize("item", OBJECTS, ids=lambda item: item.name)
def test_no_thing_is_belied_by_its_own_colour(item) -> None:
    assert claims.belied(f"{item.colour} {item.name}", item.name) == ""
    assert claims.belied(f"wooden {item.name}", item.name) == "wooden"


def test_a_colour_of_something_else_claims_nothing() -> None:
    assert claims.belied("brick of orange juice", "carton") == ""
    assert claims.belied("red wine glass", "glass") == ""
    assert claims.belied("red glass", "glass") == "red"


@pytest.mark.parametrize(
    "text", ["put it on the cheese", "put it where the cheese is", "place it on top of the cheese"]
)
def test_what_lies_on_the_table_is_no_plate(low_level: LowLevel, text: str) -> None:
    body, objects = gripping(index("ham"))
    goal, cheese = LanguageGoal(text=text), index("cheese")
    objects[cheese, :2] = objects[PLATE, :2] + np.array([0.2, 0.0])
    assert "no cheese lies there" in low_level.objection(body, objects, goal)
    objects[cheese, :2] = objects[PLATE, :2]
    assert low_level.objection(body, objects, goal) == ""


def test_nobody_remembers_what_was_where(low_level: LowLevel) -> None:
    body, objects = gripping(index("ham"))
    for text, why in (("put it where the plate was", claims.WAS), ("put it back where it was", "")):
        assert why in low_level.objection(body, objects, LanguageGoal(text=text))
        assert bool(why) is bool(low_level.objection(body, objects, LanguageGoal(text=text)))


def test_where_things_lie() -> None:
    objects = np.zeros((18, 9), np.float32)
    ham, can = index("ham"), index("can")
    objects[[PLATE, BIN, ham, can], 0] = 0.0, 1.0, 0.06, 1.09
    objects[[PLATE, BIN, ham, can], 2] = 0.01
    found = place_of(objects)
    assert (found[ham], found[can], found[index("cup")]) == (PLATE, BIN, -1)
    objects[ham, 0] = 0.09
    assert place_of(objects)[ham] == -1
