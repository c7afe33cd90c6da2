"""What people say to the low level that comes with the project is read as they mean it."""

from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from numpy.typing import NDArray

from shared.errors import PolicyError
from shared.goals.family import Floats
from shared.goals.language.encoder import shared_encoder
from shared.policies.reader.reader import Reader
from shared.workcell.objects import BODY_NAMES, KITCHEN, TABLE
from shared.workcell.skills import COMMANDS, PUT_DOWN, PUT_IN_BIN, PUT_IN_TUB, PUT_ON_PLATE, WAIT
from tests.unit.policies.reads import read

DISHES = np.array([name in TABLE for name in BODY_NAMES])
FOOD = np.array([name in KITCHEN for name in BODY_NAMES])
PHRASES = ("no, grab the mug", "set it down", "do a backflip", "fetch the tumbler, please")


class Deaf:
    """An encoder that must not be asked, but for the commands, when a reader is made."""

    def embed(self, sentences: Iterable[str]) -> Floats:
        """Refuses."""
        if tuple(sentences) == COMMANDS:
            return shared_encoder().embed(COMMANDS)
        raise PolicyError(f"asked to read {list(sentences)}")

    def is_word(self, text: str) -> bool:
        """Refuses."""
        raise PolicyError(f"asked about {text!r}")

    def states(self, sentence: str) -> Floats:
        """Refuses."""
        raise PolicyError(f"asked to read {sentence!r}")


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("no, grab the mug", "pick up the cup"),
        ("No, the bowl!", "pick up the bowl"),
        ("not the cup, take the glass", "pick up the glass"),
        ("could you please fetch the tumbler", "pick up the glass"),
        ("the soda can first, thanks", "pick up the can"),
        ("would you mind taking the serviette", "pick up the napkin"),
        ("lift the tea cup from the table", "pick up the cup"),
        ("wait, no, I want the juice box instead", "pick up the carton"),
        ("the candy wrapper next", "pick up the wrapper"),
        ("pick the cup up", "pick up the cup"),
        ("put the cup down", PUT_DOWN),
        ("no, put that back where it was", PUT_DOWN),
        ("let go of it please", PUT_DOWN),
        ("please throw it in the trash", PUT_IN_BIN),
        ("into the garbage with it", PUT_IN_BIN),
        ("the mug goes in the grey tub", PUT_IN_TUB),
        ("no, it belongs with the dirty dishes", PUT_IN_TUB),
        ("stop right there", WAIT),
        ("hang on a moment, please", WAIT),
    ],
)
def test_a_phrase_about_dishes_and_rubbish(reader: Reader, text: str, meant: str) -> None:
    assert read(reader, text, DISHES) == meant


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("no, the cheddar", "pick up the cheese"),
        ("hand me a slice of tomato, will you", "pick up the tomato"),
        ("grab the salad leaf", "pick up the lettuce"),
        ("now take the toasted slice", "pick up the toast"),
        ("stack it on the sandwich", PUT_ON_PLATE),
        ("put it on the dinner plate, please", PUT_ON_PLATE),
        ("put it on the table", PUT_DOWN),
    ],
)
def test_a_phrase_about_food(reader: Reader, text: str, meant: str) -> None:
    assert read(reader, text, FOOD) == meant


@pytest.mark.parametrize("before", ["", "no, ", "please ", "no no, "])
def test_opposites_are_not_confused(reader: Reader, before: str) -> None:
    everything = FOOD | DISHES
    for text, meant in {
        "set it down": PUT_DOWN,
        "put the bowl down": PUT_DOWN,
        "lift the bowl up": "pick up the bowl",
        "drop it onto the plate": PUT_ON_PLATE,
        "drop it into the bin": PUT_IN_BIN,
        "drop it into the tub": PUT_IN_TUB,
    }.items():
        assert read(reader, before + text, everything) == meant, before + text


@pytest.mark.parametrize(
    "text",
    [
        "do a backflip", "please sing a song", "wash the cup", "pick up the banana",
        "put it in the oven", "put it on the left", "put it on the right",
        "pick up the cup and the bowl", "move left", "don't pick up the cup", "asdf qwer",
        "put it next to the plate", "put it under the bin", "take it out of the bin",
        "anything but the cup", "pick up the purple dragon", "put the banana in the bin",
        "close your hand",
    ],
)  # fmt: skip
def test_what_nobody_here_can_do_is_refused_with_the_nearest(reader: Reader, text: str) -> None:
    reading = reader.read(text, DISHES)
    assert reading.command is None
    near = [text for text, _ in reader.nearest(text, DISHES)]
    assert len(near) == 3
    assert not {"pick up the cheese", "pick up the ham"} & set(near)


@pytest.mark.parametrize(
    ("text", "there", "like"),
    [
        ("eat the cheese", FOOD, "pick up the cheese"),
        ("slice the bread", FOOD, "pick up the bread"),
        ("clear the glass", DISHES, "pick up the glass"),
    ],
)
def test_nearest_to_what_is_like_no_command_is_the_sentence_most_like_it(
    reader: Reader, text: str, there: NDArray[np.bool_], like: str
) -> None:
    assert reader.read(text, there).command is None
    assert reader.nearest(text, there, empty=True)[0][0] == like


def test_nearest_to_a_command_about_what_is_missing_is_what_it_is_like(reader: Reader) -> None:
    near = dict(reader.nearest("put it in the tub", FOOD, empty=False))
    assert PUT_IN_TUB not in near
    assert any(near.values())
    assert not set(dict(reader.nearest("put it in the bin", FOOD, empty=True))) & {
        PUT_IN_BIN,
        PUT_DOWN,
        PUT_ON_PLATE,
    }


def test_commands_as_they_are_need_no_encoder(reader: Reader) -> None:
    deaf = reader.with_encoder(Deaf())
    assert [read(deaf, f" {text.upper()}.", FOOD) for text in COMMANDS] == list(COMMANDS)
    with pytest.raises(PolicyError, match="asked"):
        deaf.read("grab the mug", DISHES)


def test_many_threads_read_alike(reader: Reader) -> None:
    fresh = reader.with_encoder(shared_encoder())
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda text: fresh.read(text, DISHES), PHRASES * 4))
    for text, reading in zip(PHRASES * 4, found, strict=True):
        assert np.array_equal(reading.scores, reader.read(text, DISHES).scores), text
