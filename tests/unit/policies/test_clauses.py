"""What is forbidden, asked or left out is not done, and said so; by the reader of the project."""

from collections.abc import Callable

import numpy as np
import pytest

from shared.goals.language.encoder import shared_encoder
from shared.messages.goal import LanguageGoal
from shared.policies import checkpoint
from shared.policies.low_level import LowLevel
from shared.policies.reader import clauses, verbs
from shared.policies.reader.phrase import ACT, FILLER, PLACE, unlike
from shared.policies.reader.reader import Reader
from shared.workcell.objects import BODY_NAMES, KITCHEN, TABLE, index
from shared.workcell.skills import PUT_DOWN, PUT_IN_BIN, PUT_ON_PLATE, WAIT
from tests.unit.policies.reads import read
from tests.unit.policies.scenes import gripping, senses

FOOD = np.array([name in KITCHEN for name in BODY_NAMES])
DISHES = np.array([name in TABLE for name in BODY_NAMES])
CHEESE = "pick up the cheese"


@pytest.fixture(scope="module")
def low_level() -> LowLevel:
    return LowLevel.load(checkpoint.bundled("low_level"), shared_encoder())


@pytest.fixture(scope="module")
def reader(low_level: LowLevel) -> Reader:
    return low_level.reader


@pytest.fixture(scope="module")
def why(low_level: LowLevel) -> Callable[[str, str], str]:
    """Why a phrase is refused in the kitchen, with a thing in the hand or nothing."""

    def objection(text: str, held: str) -> str:
        body, objects = gripping(index(held)) if held else senses()
        return low_level.objection(body, objects, LanguageGoal(text=text))

    return objection


@pytest.mark.parametrize(
    "text",
    [
        "don't put it down", "please don't put it down", "dont put it down", "don't drop it",
        "don't put it on the plate", "don't throw it away", "never put it in the bin",
        "I don't want it on the plate",
        "you shouldn't put it on the plate", "you mustn't put it on the plate",
        "it doesn't go in the bin", "stop putting it on the plate", "don't stop", "don't wait",
        "don't bin it", "no dropping it", "no more putting it in the bin", "don't leave it there",
        "that's not for the bin", "not in the bin",
        "try not to drop it", "it shouldn't be thrown away", "don't get rid of it",
        "there's no need to put it down", "don't put it in the bin or on the plate",
        "don't pick up the ham", "never pick up the ham", "don't take the ham",
        "stop picking up the ham", "don't pick up the ham or the cheese",
        "nobody said put it down", "no one asked you to put it in the bin",
        "whatever you do, leave the ham alone", "don't snaffle the ham", "don't defenestrate it",
    ],
)  # fmt: skip
def test_a_prohibition_is_refused_and_what_it_forbids_is_not_what_is_nearest(
    reader: Reader, text: str
) -> None:
    free = text.replace("don't ", "").replace("dont ", "").replace("never ", "")
    assert reader.read(text, FOOD).command is None
    assert reader.read(text, FOOD).why == clauses.FORBIDS
    near = [text for text, _ in reader.nearest(text, FOOD)]
    assert len(near) == 3
    assert read(reader, free, FOOD) != near[0]


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("don't move", WAIT),
        ("don't do anything", WAIT),
        ("not yet", WAIT),
        ("not now", WAIT),
        ("don't hold it", ""),
        ("don't keep it", PUT_DOWN),
        ("stop holding it", PUT_DOWN),
        ("don't forget to put it down", PUT_DOWN),
        ("don't worry put it down", PUT_DOWN),
        ("why don't you put it down", PUT_DOWN),
        ("can't you put it down?", PUT_DOWN),
        ("put it down, but don't drop it", PUT_DOWN),
        ("put it down without dropping it", PUT_DOWN),
        ("not there, on the plate", PUT_ON_PLATE),
        ("don't put it on the plate, put it down", PUT_DOWN),
        ("don't put it on the plate put it down", PUT_DOWN),
        ("put it down gently, don't throw it", PUT_DOWN),
        ("don't put it on the plate but in the bin", PUT_IN_BIN),
        ("no, don't put it on the plate, put it in the bin", PUT_IN_BIN),
        ("no, don't pick up the ham, pick up the cheese", CHEESE),
        ("don't take the ham, take the cheese", CHEESE),
        ("never pick up the ham, I want the cheese", CHEESE),
    ],
)
def test_what_is_said_besides_a_prohibition_counts(reader: Reader, text: str, meant: str) -> None:
    assert read(reader, text, FOOD) == meant


@pytest.mark.parametrize(
    "text",
    [
        "something meat-free", "something without meat", "the vegetarian one",
        "anything that's not meat", "something that isn't ham", "the one that isn't ham",
        "pick up something other than the ham", "take the one without ham", "anywhere but the bin",
        "put it anywhere but the bin", "put it anywhere except on the plate",
    ],
)  # fmt: skip
def test_what_is_not_meant_is_no_name(reader: Reader, text: str) -> None:
    assert reader.read(text, FOOD).command is None
    assert reader.read(text, FOOD).why == clauses.EXCLUDES


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("the slice that isn't toasted", "pick up the bread"),
        ("the red one that isn't meat", "pick up the tomato"),
        ("the cheese without the holes", "pick up the cheese"),
        ("the round red veggie", "pick up the tomato"),
    ],
)
def test_what_a_thing_is_not_may_tell_it_from_another(
    reader: Reader, text: str, meant: str
) -> None:
    assert read(reader, text, FOOD) == meant


def test_what_a_thing_is_not_is_told_by_its_words() -> None:
    assert unlike("one that isn't the ham") == "ham"
    assert unlike("something without meat") == "meat"
    assert unlike("cheese") == ""


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("did you put it in the bin?", clauses.ASKS),
        ("should I put it on the plate?", clauses.ASKS),
        ("is the ham in the bin?", clauses.ASKS),
        ("what is in the bin?", clauses.ASKS),
        ("who put it in the bin?", clauses.ASKS),
        ("why did you put it in the bin?", clauses.ASKS),
        ("can I put it in the bin?", clauses.ASKS),
        ("put it in the left tub", clauses.SIDE),
        ("put it in the bin on the left", clauses.SIDE),
        ("put it in the bin on the right", clauses.SIDE),
        ("put it in the right-hand bin", clauses.SIDE),
        ("put the ham on the left of the plate", clauses.SIDE),
        ("place it on the left of the table", clauses.SIDE),
        ("put it down on the right side", clauses.SIDE),
        ("put it next to the plate", clauses.NEARBY),
        ("stow it beside the blue drum", clauses.NEARBY),
        ("set it down near the bin", clauses.NEARBY),
        ("deposit it on the edge of the tub", clauses.NEARBY),
        ("place it to the left of the plate", clauses.NEARBY),
        ("remove it from the sandwich", clauses.REMOVES),
        ("get it off the plate", clauses.REMOVES),
        ("take all the dishes", clauses.SEVERAL),
        ("put all the food in the bin", clauses.SEVERAL),
        ("put everything in the bin", clauses.SEVERAL),
        ("put it down and pick up the ham", clauses.in_turn("put it down")),
        ("put it down, pick up the ham", clauses.in_turn("put it down")),
        ("let go and wait", clauses.in_turn("let go")),
        ("take the cup, then throw away the can", clauses.in_turn("take the cup")),
    ],
)
def test_what_cant_be_meant_so_is_refused_with_the_reason(
    reader: Reader, text: str, why: str
) -> None:
    for there in (FOOD, DISHES):
        assert reader.read(text, there).command is None
        assert reader.read(text, there).why == why


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("can you put it in the bin?", PUT_IN_BIN),
        ("do you mind putting it down?", PUT_DOWN),
        ("is it possible to put it down?", PUT_DOWN),
        ("could I have the ham", "pick up the ham"),
        ("what about the ham?", "pick up the ham"),
        ("what's in your hand goes in the bin", PUT_IN_BIN),
        ("is that clean? then put it on the plate", PUT_ON_PLATE),
        ("take the left tomato", "pick up the tomato"),
        ("take the tomato on the left", "pick up the tomato"),
        ("put the left tomato on the plate", PUT_ON_PLATE),
        ("put the cheese on the left in the bin", PUT_IN_BIN),
        ("put it right in the bin", PUT_IN_BIN),
        ("put it down with your left hand", PUT_DOWN),
        ("the right place for it is on the plate", PUT_ON_PLATE),
        ("take the ham off the plate", "pick up the ham"),
        ("pick up the ham to the left of the plate", "pick up the ham"),
        ("take the ham next to the plate", "pick up the ham"),
        ("put it over there on the plate", PUT_ON_PLATE),
        ("set it by itself", PUT_DOWN),
        ("go and get the ham", "pick up the ham"),
        ("leave it and take the ham", "pick up the ham"),
        ("I can't reach the ham, get it for me", "pick up the ham"),
        ("put your hand on the ham and take it", "pick up the ham"),
        ("stop and put it down", PUT_DOWN),
        ("wait, put it down", PUT_DOWN),
        ("put it down, no, pick up the ham", "pick up the ham"),
        ("leave the ham alone, take the cheese", CHEESE),
        ("hmm, too dry still. take the tomato", "pick up the tomato"),
        ("we need something fresh, so take the lettuce", "pick up the lettuce"),
        ("someone left the cheddar there, gather it up", CHEESE),
    ],
)
def test_what_only_looks_like_it_is_read(reader: Reader, text: str, meant: str) -> None:
    assert read(reader, text, FOOD) == meant


@pytest.mark.parametrize(
    ("text", "held", "reason"),
    [
        ("pick up the cheese and put it on the plate", "", f"say {CHEESE!r} first"),
        ("pick up the cheese and put it on the plate", "ham", f"say {CHEESE!r} first"),
        ("pick up the cheese and put it on the plate", "cheese", ""),
        ("pick up the plate", "", "nobody here can take the plate"),
        ("give me the plate", "", "nobody here can take the plate"),
        ("take the bin", "", "doesn't understand"),
        ("pick up the tub", "", "doesn't understand"),  # None is there.
        ("place the slice onto the dish", "cheese", ""),
        ("place the meat onto the plate", "lettuce", "not what is in the hand"),
        ("put the vegetable on the plate", "tomato", ""),
        ("put the salad ingredient on the plate", "tomato", "hardly what is in the hand"),
        ("don't put it down", "cheese", "say what to do instead; nearest it knows: '"),
    ],
)
def test_the_reason_is_true(
    why: Callable[[str, str], str], text: str, held: str, reason: str
) -> None:
    found = why(text, held)
    assert reason in found
    assert bool(found) is bool(reason)


def test_clauses_need_no_more_than_words_and_parts() -> None:
    parts = [ACT] * 4 + [ACT] * 2 + [PLACE] * 3
    found = clauses.judged("don't put it down, put it in the bin", parts)
    assert found == clauses.Clauses([FILLER] * 4 + parts[4:])
    assert clauses.judged("don't put it down", parts[:4]).why == clauses.FORBIDS
    assert clauses.judged("", []) == clauses.Clauses([])


@pytest.mark.parametrize(
    ("said", "kind"),
    [
        ("putting", verbs.PUT), ("placed", verbs.PUT), ("picks", verbs.PICK),
        ("dropping", verbs.PUT), ("let it go", verbs.PUT), ("let me", ""),
        ("get rid", verbs.PUT), ("get it", verbs.PICK), ("put your hand", verbs.MOVE),
        ("hand me", verbs.PICK), ("hand", ""), ("sing", ""), ("snaffling", verbs.PICK),
        ("yeet it", verbs.PUT), ("froze", ""), ("freeze", verbs.WAIT),
    ],
)  # fmt: skip
def test_verbs_are_known_in_all_their_forms(said: str, kind: str) -> None:
    assert verbs.verb_of(said.split(), 0) == kind
