"""Phrases as people say them: each writing by a writer who had not seen the lexicon.

Each file of `everyday/` is one writing of a dozen or so phrases a command, and of what is to be
refused. No reader is fitted to them. By what was missed in most of them the lexicon and the limits
grew: they are for development. What is `held_out` was counted before anybody looked at it; whoever
teaches a word because of it takes that mark away.
"""

import re
import tomllib
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from importlib import resources
from itertools import chain
from typing import Any, NamedTuple

from services.learner.pretrain.lexicon import exam
from shared.policies.reader.phrase import words_of
from shared.policies.reader.reader import bare
from shared.workcell.skills import COMMANDS, parse

REFUSE, HELD, HELD_OUT = "refuse", "held", "held_out"


class Writing(NamedTuple):
    """said: phrases of each command. refused: phrases to be refused. held: by phrase the thing that
    is in the hand, where it is named. held_out: no word was ever taught because of it."""

    name: str
    said: dict[str, tuple[str, ...]]
    refused: tuple[str, ...]
    held: dict[str, str]
    held_out: bool


@cache
def writings() -> tuple[Writing, ...]:
    """All of them, by name."""
    folder = resources.files("services.learner.pretrain").joinpath("everyday")
    texts = {file.name: file.read_text() for file in folder.iterdir()}
    return tuple(
        _writing(name.removesuffix(".toml"), tomllib.loads(texts[name])) for name in sorted(texts)
    )


def _writing(name: str, table: dict[str, Any]) -> Writing:
    said = {command: tuple(table[command]) for command in COMMANDS}
    return Writing(
        name, said, tuple(table[REFUSE]), dict(table.get(HELD, {})), bool(table.get(HELD_OUT))
    )


def sealed(every: Sequence[Writing]) -> frozenset[str]:
    """Phrases of what is held out, said or refused, that no other writing has: one of the others
    may have taught them."""
    writers: dict[str, set[str]] = defaultdict(set)
    for writing in every:
        for text in _phrases(writing):
            writers[bare(text)].add(writing.name)
    return frozenset(
        text
        for writing in every
        if writing.held_out
        for text in _phrases(writing)
        if writers[bare(text)] == {writing.name}
    )


def _phrases(writing: Writing) -> Iterable[str]:
    return chain(*writing.said.values(), writing.refused)


def has_new_word(phrase: str) -> bool:
    """Whether a word of it was never taught, in any place."""
    return not _taught().issuperset(words_of(phrase))


def forms_of(phrase: str, command: str) -> tuple[str, ...]:
    """In which ways a phrase differs from its command; names of `FORMS`, several may hold."""
    return tuple(name for name, differs in FORMS.items() if differs(phrase.lower(), command))


def _another_noun(phrase: str, command: str) -> bool:
    thing = parse(command).object
    return thing is not None and not set(thing.split()) <= set(words_of(phrase))


FORMS: dict[str, Callable[[str, str], bool]] = {
    "another verb": lambda phrase, _: not {"pick", "put", "wait"} & set(words_of(phrase)),
    "another noun": _another_noun,
    "another order": lambda phrase, _: re.match(r"(the|that|this)\b", phrase) is not None,
    "courtesy": lambda phrase, _: (
        re.search(r"\b(please|could you|would you|can you|mind|thanks?|kindly|i'd like)\b", phrase)
        is not None
    ),
    "protest in front": lambda phrase, _: (
        re.match(r"(no|nope|nah|not|stop|wait|actually|wrong)\b", phrase) is not None
    ),
}
"""Told by words alone, so only roughly: another order begins with the thing."""


@cache
def _taught() -> frozenset[str]:
    known = exam()[0]
    return frozenset(word for table in known for text in _texts(table) for word in words_of(text))


def _texts(table: dict[str, tuple[tuple[str, ...], ...]]) -> Iterable[str]:
    return (text for groups in table.values() for group in groups for text in group)
