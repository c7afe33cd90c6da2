"""The words of a phrase, the parts that they play, and what is left when they are taken apart."""

import re
from collections.abc import Sequence
from itertools import groupby
from typing import NamedTuple

from shared.goals.language.encoder import WORD
from shared.policies.reader.spoken import unaccented

FILLER, ACT, THING, PLACE, CONTRAST = PARTS = range(5)
"""Courtesy, protest and where a thing lies; what to do; what with; where to; a thing not meant."""

_STANDS_FOR = {THING: "the object", PLACE: "to that place"}
_JOINING = frozenset(("and", "or", "plus"))
POINTING = frozenset(
    ("it", "that", "this", "the", "them", "one", "thing", "object", "item", "sample", "specimen")
)
_HANDS = frozenset(("hand", "hands", "gripper", "claw", "fingers", "grip", "pincers", "fist"))
_FIXTURES = frozenset(("plate", "dish", "table", "bin", "tub", "sandwich", "stack"))
PLACES_OF = _FIXTURES | frozenset(
    ("pile", "tray", "top", "counter", "worktop", "side", "others", "rest", "other", "box")
)
"""Names of places, and of what lies there."""
_EMPTY = frozenset(
    ("them", "empty", "used", "dirty", "old", "poor", "lovely", "nice", "silly", "daft", "trusty",
     "left", "right", "leftmost", "rightmost", "left-hand", "right-hand", "far")
)  # fmt: skip
"""Before the name of a thing they tell nothing of what it is."""
_RELATING = frozenset(("on", "in", "into", "onto", "next", "under", "behind", "beside", "near"))
"""Right before a place they belong to it."""
_ASKING = frozenset(("can", "could", "would", "will"))
ARTICLES = frozenset(("the", "a", "an", "my", "your", "its"))
DETERMINERS = frozenset(
    ("the", "a", "an", "that", "this", "these", "those", "my", "your", "some", "one", "of")
)


_NOT = re.compile(r"(.*)\b(?:not|no|without|except|but|\w+n't)\b")


class Parts(NamedTuple):
    """A phrase taken apart.

    frame: what to do, with "the object" for each thing and "to that place" for each place.
    things: without their determiners. places: as they were said.
    why: why it can't be obeyed, "" if it can. first: what it says to do before.
    idle: why it may only ask to wait, "" if it may ask for more. holds: it asks to go on holding.
    side: "left" or "right", where its thing lies; two: since it doesn't lie on the other.
    arm: "left" or "right", the arm or hand that it names. ranked: it ranks things, or tells them by
    others. onto: things that it names where something is to be put.
    """

    frame: str
    things: tuple[str, ...]
    places: tuple[str, ...]
    why: str = ""
    first: str = ""
    idle: str = ""
    holds: bool = False
    side: str = ""
    two: bool = False
    arm: str = ""
    ranked: bool = False
    onto: tuple[str, ...] = ()

    def texts(self) -> tuple[str, ...]:
        """All that must be embedded: the frame, things and places, what things are said not to
        be."""
        return self.frame, *self.things, *self.places, *self.others(), *self.onto

    def others(self) -> tuple[str, ...]:
        """What its things are said not to be, and to be: "ham" and "one that" of "one that isn't
        ham"."""
        return tuple(filter(None, (*map(unlike, self.things), *map(likened, self.things))))


def unlike(thing: str) -> str:
    """What a thing is said not to be, "" where nothing is said of that."""
    found = _NOT.match(thing)
    return " ".join(_bare(words_of(thing[found.end() :]))) if found else ""


def likened(thing: str) -> str:
    """What is said of a thing before what it is not: "cup" of "cup without a handle"; or ""."""
    found = _NOT.match(thing)
    return " ".join(_bare(words_of(found.group(1)))) if found else ""


def plain(text: str) -> str:
    """In lower case, single spaces, straight apostrophes, no accents."""
    return " ".join(unaccented(text).lower().replace("’", "'").split())


def words_of(text: str) -> list[str]:
    """The words of a plain text, without punctuation."""
    return WORD.findall(plain(text))


def take_apart(words: Sequence[str], parts: Sequence[int]) -> Parts:
    """What the words say, each playing its part."""
    parts = related(words, parts)
    frame: list[str] = []
    found: dict[int, list[str]] = {THING: [], PLACE: []}
    for part, run in groupby(zip(words, parts, strict=True), key=lambda pair: pair[1]):
        said = [word for word, _ in run]
        if part == ACT or (part == THING and POINTING.issuperset(said)):
            frame += said
        elif part == THING:
            for thing in _listed(said):
                frame.append(_STANDS_FOR[part])
                found[part].append(" ".join(_bare(thing)))
        elif part == PLACE:
            frame.append(_STANDS_FOR[part])
            found[part].append(" ".join(said))
    return Parts(" ".join(frame), tuple(found[THING]), tuple(found[PLACE]))


def related(words: Sequence[str], parts: Sequence[int]) -> list[int]:
    """The parts, put right where words belong together: an article to what follows it, which also
    a place must have; "next to" and the like to the place that follows; "can you" is courtesy."""
    told = list(parts)
    for at in range(len(told) - 1):
        if told[at] == PLACE and told[at + 1] in (ACT, FILLER) and words[at] in ARTICLES:
            told[at + 1] = PLACE
        if told[at] == ACT and words[at] in _ASKING and words[at + 1] == "you":
            told[at : at + 2] = FILLER, FILLER
    for at in reversed(range(len(told) - 1)):
        if told[at] == ACT and told[at + 1] == PLACE and words[at] in _RELATING:
            told[at] = PLACE
        if words[at] in ARTICLES and told[at + 1] in (THING, CONTRAST):
            told[at] = told[at + 1]
    _found_there(words, told)
    for at, word in enumerate(words):  # What is in the robot's own hand is no place.
        begin = at - 2 if at > 1 and words[at - 1] in ("your", "the") else at - 1
        if told[at] == PLACE and word in _HANDS and words[max(begin, 0)] in ("in", "into"):
            told[begin : at + 1] = [ACT] * (at + 1 - begin)
    return told


def _found_there(words: Sequence[str], told: list[int]) -> None:
    """Where a thing that was named lies is no act: "the ham off the plate"."""
    for at in range(1, len(words) - 1):
        end = at + 1 + (words[at + 1] in ARTICLES)
        near = words[at] in ("off", "from") and told[at - 1] == THING and told[at] == ACT
        if near and end < len(words) and words[end] in _FIXTURES:
            told[at : end + 1] = [FILLER] * (end + 1 - at)


def _listed(nouns: list[str]) -> list[list[str]]:
    """Things that were told as one, each by itself."""
    runs = groupby(nouns, key=lambda word: word in _JOINING)
    return [list(run) for joins, run in runs if not joins]


def _bare(noun: list[str]) -> list[str]:
    while len(noun) > 1 and noun[0] in DETERMINERS | _EMPTY:
        noun = noun[1:]
    last = [word.removesuffix("'s") for word in noun[-1:]]  # "The cup's next".
    return [*noun[:-1], *last]
