"""Sides, ranks and arms: both sides in the same forms, and nothing that only looks like a side."""

import pytest

from shared.goals.language.encoder import shared_encoder
from shared.messages.goal import LanguageGoal
from shared.policies import checkpoint
from shared.policies.low_level import LowLevel
from shared.policies.reader import located, ranked
from shared.workcell.objects import BIN, index
from tests.unit.policies.reads import said, scene

CUP, SAUCER = "pick up the cup", "pick up the saucer"
SIDES = [("left", "right", CUP), ("right", "left", SAUCER)]
AT = {"cup": -0.2, "saucer": 0.2, "can": 0.0}
"""Two dishes, and a thing between them."""
FORMS = [
    "take the dish on the {side}", "the dish on the {side}", "the {side} dish",
    "grab the {side} one", "the {side}most dish", "the {side}-hand dish",
    "the dish on the {side} hand side",
    "the dish furthest to the {side}", "the dish that is on the {side}", "I want the {side} dish",
    "the dish that is not on the {other}", "the dish that isn't on the {other}",
    "pick up the dish not on the {other}", "the dish which is not the {other} one",
    "take the dish, not the {other} one", "not the {other} dish, the {side} one",
    "not the {other} dish the {side} one", "the {side} dish, not the {other} one",
    "don't take the {other} dish, take the {side} one", "the {other} dish, sorry, the {side} one",
    "wrong dish, the {side} one", "the dish, the {side} one", "the {side} one of the dishes",
    "can you get the {side} dish please", "{side} dish",
]  # fmt: skip


@pytest.fixture(scope="module")
def low_level() -> LowLevel:
    return LowLevel.load(checkpoint.bundled("low_level"), shared_encoder())


@pytest.mark.parametrize("before", ["", "no, "])
@pytest.mark.parametrize(("side", "other", "taken"), SIDES)
@pytest.mark.parametrize("form", FORMS)
def test_each_side_is_read_in_each_form(
    low_level: LowLevel, form: str, side: str, other: str, taken: str, before: str
) -> None:
    text = before + form.format(side=side, other=other)
    assert said(low_level, text, **AT) == (taken, "")
    assert low_level.nearest(*scene(**AT), LanguageGoal(text=text))[0][0] == taken


@pytest.mark.parametrize("form", FORMS)
def test_what_is_read_but_for_the_side_is_the_same(form: str) -> None:
    left, right = (located.located(form.format(side=one, other=two)) for one, two, _ in SIDES)
    assert right == left._replace(side="right")
    assert (left.side, left.why) == ("left", "")


@pytest.mark.parametrize(("side", "other", "taken"), SIDES)
def test_a_side_alone_tells_one_of_all(
    low_level: LowLevel, side: str, other: str, taken: str
) -> None:
    del other
    row = index("cup" if taken == CUP else "saucer")
    assert low_level._read(f"the one on the {side}", scene(**AT)[1]).command == row
    assert said(low_level, f"the red one on the {side}", **{**AT, "can": -0.3})[0] == (
        "pick up the can" if side == "left" else CUP
    )


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize(
    ("form", "why"),
    [
        ("the thing that is not on the {}", "not to be on a side tells one only of two"),
        ("not the cup, the {} one", located.WHICH),
        ("no, on the {}", located.BARE),
        ("the {}", located.BARE),
        ("take the dish with the {} arm", located.ARM),
        ("pick up the cup with your {} hand", located.ARM),
        ("use your {} gripper to take the cup", located.ARM),
        ("the dish is on the {}", "tells how things are"),
        ("is the {} dish dirty?", "is a question"),
        ("don't take the {} dish", "say what to do instead"),
        ("put the left dish in the tub", located.SIDED),
        ("put the dish on the {}", located.SIDE),
        ("the second dish from the {}", ranked.RANKED),
    ],
)
def test_what_a_side_cant_tell_is_refused_with_the_reason(
    low_level: LowLevel, form: str, why: str, side: str
) -> None:
    meaning, refused = said(low_level, form.format(side), **AT)
    assert meaning == ""
    assert why in refused


@pytest.mark.parametrize(
    "text",
    [
        "largest dish", "the smallest dish", "the second dish", "the thing next to the cup",
        "the dish nearest to you", "the dish behind the can", "the tallest one",
    ],
)  # fmt: skip
def test_what_would_have_to_be_compared_is_refused(low_level: LowLevel, text: str) -> None:
    meaning, refused = said(low_level, text, **AT)
    assert meaning == ""
    assert ranked.RANKED in refused


def test_where_a_name_is_enough_ranks_and_places_do_not_matter(low_level: LowLevel) -> None:
    for text in ("the smallest cup", "the cup next to the can", "the dish behind the can"):
        assert said(low_level, text, cup=-0.2, can=0.1) == (CUP, "")


@pytest.mark.parametrize("hand", ["left", "right"])
def test_a_hand_that_holds_nothing_puts_nothing(low_level: LowLevel, hand: str) -> None:
    body, objects = scene(cup=-0.2, saucer=0.1)
    body[6], body[13], body[14:17] = 0.04, 0.08, (0.3, 0.0, 0.2)
    objects[index("cup"), :3] = body[14:17]
    why = low_level.objection(
        body, objects, LanguageGoal(text=f"put it down with your {hand} hand")
    )
    assert ("the right hand is empty" in why) is (hand == "right")
    assert bool(why) is (hand == "right")


def test_what_lies_in_the_bin_is_on_no_side(low_level: LowLevel) -> None:
    body, objects = scene(cup=-0.2, saucer=0.0)
    objects[index("saucer"), :2] = objects[BIN, :2]
    goal = LanguageGoal(text="the dish on the right")
    assert low_level.meaning(goal, objects) == CUP
    assert low_level.objection(body, objects, goal) == ""
