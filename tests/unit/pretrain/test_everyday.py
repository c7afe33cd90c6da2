"""The writings are whole: each command has phrases, and what is held is named by one of them."""

import pytest

from services.learner.pretrain.everyday import Writing, forms_of, sealed, writings
from shared.workcell.objects import OBJECT_NAMES
from shared.workcell.skills import COMMANDS, PUTS


@pytest.mark.parametrize("writing", writings(), ids=lambda writing: writing.name)
def test_a_writing_has_phrases_for_each_command_and_says_what_is_held(writing: Writing) -> None:
    assert tuple(writing.said) == COMMANDS
    assert min(map(len, writing.said.values())) >= 10
    assert len(writing.refused) >= 40
    puts = {text for command in PUTS for text in writing.said[command]}
    assert writing.held.keys() <= puts
    assert set(writing.held.values()) <= set(OBJECT_NAMES)


def test_one_writing_at_least_is_held_out() -> None:
    assert {writing.name for writing in writings() if writing.held_out} < {
        writing.name for writing in writings()
    }
    assert any(writing.held_out for writing in writings())


def test_what_another_writing_has_too_is_not_held_out() -> None:
    def writing(name: str, said: str, refused: str, held_out: bool = False) -> Writing:
        return Writing(name, {"wait": (said, f"{name} waits")}, (refused,), {}, held_out)

    every = (
        writing("a", "Hold on.", "sing"),
        writing("b", "hold  on", "dance", held_out=True),
        writing("c", "stay there", "dance!", held_out=True),
    )
    assert sealed(every) == {"b waits", "c waits", "stay there"}
    assert sealed(every[:2]) == {"b waits", "dance"}
    assert sealed(every[:1]) == frozenset()


@pytest.mark.parametrize(
    ("phrase", "command", "forms"),
    [
        ("pick up the bread", "pick up the bread", ()),
        ("Could you grab the bread", "pick up the bread", ("another verb", "courtesy")),
        ("pick up that slice", "pick up the bread", ("another noun",)),
        (
            "the slice, get it",
            "pick up the bread",
            ("another verb", "another noun", "another order"),
        ),
        ("no, put it in the bin", "put it in the bin", ("protest in front",)),
        ("notice the bread and pick it up", "pick up the bread", ()),
    ],
)
def test_it_is_told_in_which_ways_a_phrase_differs_from_its_command(
    phrase: str, command: str, forms: tuple[str, ...]
) -> None:
    assert forms_of(phrase, command) == forms
