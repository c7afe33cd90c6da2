"""What people say for a command, and which command it is."""

import re

import pytest

from services.correction_api.speech.grammar import Grammar

THINGS = ("bread", "cheese", "ham", "tomato", "cup", "can")
COMMANDS = (
    *(f"pick up the {thing}" for thing in THINGS),
    "put it on the plate",
    "put it in the bin",
    "put it down",
    "wait",
)
GRAMMAR = Grammar(COMMANDS)


@pytest.mark.parametrize("command", COMMANDS)
def test_each_command_can_be_said_as_it_is_and_with_courtesies(command: str) -> None:
    for said in (command, f"no {command}", f"no please {command} now", f"robot {command} instead"):
        assert GRAMMAR.exact(said) == command


@pytest.mark.parametrize(
    ("said", "command"),
    [
        ("no, the cheese first", "pick up the cheese"),
        ("grab the ham", "pick up the ham"),
        ("in the trash", "put it in the bin"),
        ("place that onto the plate", "put it on the plate"),
        ("put it on the table", "put it down"),
        ("hold on", "wait"),
    ],
)
def test_other_words_for_it_mean_the_same_command(said: str, command: str) -> None:
    assert GRAMMAR.exact(said) == command


def test_no_sentence_means_two_commands_and_none_asks_to_stop() -> None:
    assert set(GRAMMAR.sentences.values()) == set(COMMANDS)
    assert not any("stop" in sentence for sentence in GRAMMAR.sentences)
    assert GRAMMAR.nearest("Stop!") is None


def test_what_a_robot_does_not_know_is_not_listened_for() -> None:
    few = Grammar(("wait", "pick up the ham"))
    assert "cheese" not in few.jsgf
    assert few.exact("pick up the cheese") is None


def test_a_command_that_nobody_could_hear_is_told_and_left_out() -> None:
    odd = ("<b>1</b> cheese", "wait", "schön", "pick up the zyzzyva", "", "one; <two> = three")
    grammar = Grammar(odd, spelt=lambda word: word != "zyzzyva")
    assert grammar.commands == ("wait",)
    assert set(grammar.silent) == set(odd) - {"wait"}
    assert "zyzzyva" not in grammar.jsgf


def test_a_word_of_a_persons_own_is_said_as_it_was_typed() -> None:
    grammar = Grammar(("stir the soup gently",))
    assert grammar.exact("please stir the soup gently") == "stir the soup gently"


def test_the_grammar_says_every_sentence_of_the_table() -> None:
    rule = re.search(r"<command> = (.*);", GRAMMAR.jsgf)
    assert rule
    pattern = re.sub(r"\[(.*?)\] ?|\((.*?)\) ?", _pattern, rule[1]).replace("| ", "|")
    for sentence in GRAMMAR.sentences:
        assert re.fullmatch(pattern, f"{sentence} "), sentence


def _pattern(place: re.Match[str]) -> str:
    """A place of a JSGF rule as a regular expression, each word with a space after it."""
    words = (place[1] or place[2]).replace(" | ", "|")
    return f"(?:(?:{words}) ){'?' if place[1] else ''}"


@pytest.mark.parametrize(
    ("heard", "command"),
    [
        ("No, pick up the keys first.", "pick up the cheese"),
        ("But it on the plate.", "put it on the plate"),
        ("Put it in the been.", "put it in the bin"),
        ("Pick up the c", None),
        ("What a lovely day it is today.", None),
        ("Thank you.", None),
        ("", None),
    ],
)
def test_words_that_were_misheard_mean_the_one_command_that_is_near(
    heard: str, command: str | None
) -> None:
    assert GRAMMAR.nearest(heard) == command
