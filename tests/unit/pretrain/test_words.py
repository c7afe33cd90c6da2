"""What the reader is taught, and what is kept to measure it."""

import numpy as np

from services.learner.pretrain.low_fit import known_words
from services.learner.pretrain.words import (
    known_phrases,
    refused_phrases,
    split,
    unheard_phrases,
    unheard_refusals,
)
from shared.workcell.objects import BODY_NAMES, KITCHEN, TABLE
from shared.workcell.skills import COMMANDS

THERE = np.array([name in KITCHEN or name in TABLE for name in BODY_NAMES])


def test_what_is_kept_for_tests_is_never_taught() -> None:
    taught = {text for row in known_phrases() for text in row}
    for row in unheard_phrases():
        assert len(row) >= 5
        assert not taught & {unheard.phrase for unheard in row}
    assert not set(refused_phrases()) & set(unheard_refusals())


def test_no_word_is_on_both_sides() -> None:
    known, kept = split()
    for name, nouns in kept.things.items():
        assert len(nouns) == 4
        assert not set(nouns) & set(known.things[name])
    for verb, frames in kept.frames.items():
        assert len(frames) >= 5
        assert not set(frames) & set(known.frames[verb])


def test_canonical_commands_are_read_as_they_are_and_what_has_one_word_means_one_thing() -> None:
    said = known_phrases()
    assert [row[0] for row in said] == list(COMMANDS)
    texts = [text for row in said for text in row]
    assert len(texts) == len(set(texts))


def test_a_reader_of_few_phrases_reads_and_refuses() -> None:
    reader = known_words(most=12)
    for row, command in enumerate(COMMANDS):
        assert reader.read(command.upper(), THERE).command == row
    cheese, down = COMMANDS.index("pick up the cheese"), COMMANDS.index("put it down")
    assert reader.read("no, grab the cheese please", THERE).command == cheese
    assert reader.read("please put it down", THERE).command == down
    strange = reader.read("do a backflip", THERE)
    assert strange.command is None
    nearest = reader.nearest(strange.scores, THERE)
    assert len(nearest) == 3
    assert all(text in COMMANDS for text, _ in nearest)


def test_what_is_in_the_scene_narrows_the_reading() -> None:
    reader = known_words(most=12)
    kitchen = np.array([name in KITCHEN for name in BODY_NAMES])
    for phrase in ("grab the mug", "take the napkin"):
        row = reader.read(phrase, kitchen).command
        assert row is None or reader.possible(kitchen)[row]
