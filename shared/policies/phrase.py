"""The words of a phrase, the parts that they play, and what is left when they are taken apart."""

from collections.abc import Sequence
from itertools import groupby
from typing import NamedTuple

from shared.goals.language.encoder import WORD

FILLER, ACT, THING, PLACE, CONTRAST = PARTS = range(5)
"""Courtesy, protest and where a thing lies; what to do; what with; where to; a thing not meant."""

_STANDS_FOR = {THING: "it", PLACE: "there"}
_DETERMINERS = frozenset(
    ("the", "a", "an", "that", "this", "these", "those", "my", "your", "some", "one", "of")
)


class Parts(NamedTuple):
    """A phrase taken apart.

    frame: what to do, with "it" for each thing and "there" for each place. things: without their
    determiners. places: as they were said.
    """

    frame: str
    things: tuple[str, ...]
    places: tuple[str, ...]


def plain(text: str) -> str:
    """In lower case, single spaces, straight apostrophes."""
    return " ".join(text.lower().replace("’", "'").split())


def words_of(text: str) -> list[str]:
    """The words of a plain text, without punctuation."""
    return WORD.findall(plain(text))


def take_apart(words: Sequence[str], parts: Sequence[int]) -> Parts:
    """What the words say, each playing its part."""
    frame: list[str] = []
    found: dict[int, list[str]] = {THING: [], PLACE: []}
    for part, run in groupby(zip(words, parts, strict=True), key=lambda pair: pair[1]):
        said = [word for word, _ in run]
        if part == ACT:
            frame += said
        elif part in found:
            frame.append(_STANDS_FOR[part])
            found[part].append(" ".join(said if part == PLACE else _bare(said)))
    return Parts(" ".join(frame), tuple(found[THING]), tuple(found[PLACE]))


def _bare(noun: list[str]) -> list[str]:
    while len(noun) > 1 and noun[0] in _DETERMINERS:
        noun = noun[1:]
    return noun
