"""A reader that was taught a part of the lexicon reads, refuses, and confuses no opposites."""

import numpy as np
import pytest

from services.learner.pretrain.lexicon import exam
from services.learner.pretrain.reader_fit import ReaderFitSettings, fit_reader
from services.learner.pretrain.reading_exam import Examiner, ask
from services.learner.pretrain.reading_figures import figures, table
from services.learner.pretrain.tagger_fit import TaggerFitSettings, fit_tagger
from shared.goals.language.encoder import shared_encoder
from shared.policies.reader.reader import Reader
from shared.workcell.objects import BODY_NAMES, KITCHEN, TABLE
from shared.workcell.skills import COMMANDS, PUT_DOWN, PUT_IN_BIN, PUT_IN_TUB, PUT_ON_PLATE, WAIT
from tests.unit.pretrain.lexicons import few


@pytest.fixture(scope="module")
def reader() -> Reader:
    settings = ReaderFitSettings(phrases=1500, tagger=TaggerFitSettings(epochs=8))
    return fit_reader(few(8), settings)


def read(reader: Reader, text: str, stock: frozenset[str] = TABLE) -> str:
    there = np.array([name in stock for name in BODY_NAMES])
    row = reader.read(text, there).command
    return "" if row is None else COMMANDS[row]


def test_all_canonical_commands_are_read_as_they_are(reader: Reader) -> None:
    for command in COMMANDS:
        assert read(reader, f"{command}!", KITCHEN) == command


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("no, grab the mug please", "pick up the cup"),
        ("could you fetch the bowl", "pick up the bowl"),
        ("take the cup on the left", "pick up the cup"),
        ("please put it down", PUT_DOWN),
        ("no, put that down now", PUT_DOWN),
        ("throw it away", PUT_IN_BIN),
        ("please drop it in the bin", PUT_IN_BIN),
        ("drop it in the tub", PUT_IN_TUB),
        ("hold still, please", WAIT),
    ],
)
def test_what_is_said_in_other_words_is_read(reader: Reader, text: str, meant: str) -> None:
    assert read(reader, text) == meant


@pytest.mark.parametrize(
    "text",
    [
        "do a backflip", "sing a song", "pick up the banana", "wash the cup", "eat the napkin",
        "put it in the oven",
        "pick up the cup and the bowl", "pick it up",
    ],
)  # fmt: skip
def test_what_no_robot_here_can_do_is_refused_with_the_nearest(reader: Reader, text: str) -> None:
    there = np.array([name in TABLE for name in BODY_NAMES])
    reading = reader.read(text, there)
    assert reading.command is None
    assert len(reader.nearest(text, there)) == 3


def test_a_thing_that_is_not_there_is_never_taken_for_one_that_is(reader: Reader) -> None:
    for thing in ("cheese", "ham", "lettuce"):
        assert read(reader, f"please grab the {thing}") in ("", f"pick up the {thing}")


def test_opposites_are_not_confused(reader: Reader) -> None:
    for before in ("", "no, ", "please "):
        for verb, place in (
            ("put it", PUT_ON_PLATE),
            ("put it", PUT_IN_BIN),
            ("drop it", PUT_IN_TUB),
        ):
            words = place.removeprefix("put it ")
            assert read(reader, f"{before}{verb} {words}", KITCHEN | TABLE) == place
        assert read(reader, f"{before}set it down") == PUT_DOWN
        assert read(reader, f"{before}pick the cup up") == "pick up the cup"


def test_a_tagger_goes_on_from_another_and_leaves_it_as_it_was() -> None:
    rng = np.random.default_rng(0)
    states = [rng.normal(size=(3, 8)).astype(np.float32) for _ in range(8)]
    parts = [tuple(int(state[row, 0] > 0) for row in range(3)) for state in states]
    settings = TaggerFitSettings(epochs=2, batch=4)
    first = fit_tagger(states, parts, settings, seed=0)
    before = first.tensors("parts")
    again = fit_tagger(states, parts, settings, seed=0, start=first).tensors("parts")
    after = first.tensors("parts")
    assert all(np.array_equal(after[name], value) for name, value in before.items())
    assert np.array_equal(again["parts.mean"], before["parts.mean"])
    assert not np.array_equal(again["parts.leave.weight"], before["parts.leave.weight"])


def test_the_exam_counts_every_question_once(reader: Reader) -> None:
    known, unheard = exam()
    questions = Examiner(known, unheard, seed=0).questions(1)[::3]
    answers = ask(reader, questions, shared_encoder())
    found = figures(answers)
    assert sum(kind["n"] for kind in found["kinds"].values()) == len(questions)
    # It was taught a small part of the words that are known; by chance it would be .05.
    assert found["kinds"]["only known words"]["success"] > 0.25
    assert found["refusals"]["success"] > 0.5
    assert "confused: down and pick" in table(found)
