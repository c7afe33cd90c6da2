"""What a phrase claims that may be false: colours and materials of things, and what lies where.

The tellers weigh likeness, and "the red glass" is like the glass whatever its colour. So a colour
right before a noun, or after "that is", must be one that the thing has.
"""

import re
from collections.abc import Sequence

from shared.policies.reader.looks import LOOKS
from shared.policies.reader.phrase import PLACES_OF, words_of
from shared.policies.reader.verbs import PUT, verb_of

_OTHER_COLOURS = (
    "orange black grey gray silver beige turquoise violet cyan magenta navy maroon teal"
)
_ALSO = {
    "bread": "brown beige",
    "toast": "black beige orange",
    "cheese": "orange",
    "ham": "red",
    "onion": "red white",
    "wrapper": "orange",
    "can": "silver",
}
"""Colours that a thing is often called by besides its own, or that it has elsewhere."""
_MADE_OF = {
    "wooden": "",
    "wood": "",
    "stone": "",
    "leather": "",
    "woollen": "",
    "metal": "can",
    "steel": "can",
    "tin": "can",
    "aluminium": "can wrapper",
    "cardboard": "carton",
    "paper": "napkin wrapper carton cup",
    "porcelain": "cup bowl saucer",
    "china": "cup bowl saucer",
    "ceramic": "cup bowl saucer",
}
"""What things of a material are; of nothing here is wood."""
_ALIASES = {"violet": "purple"}
_COLOURS = frozenset(
    word
    for word in " ".join((_OTHER_COLOURS, *(looks for looks in LOOKS.values()))).split()
    if word not in ("round", "pale")
)
_CLAIM = re.compile(
    rf"(?<!\bof )(?<!\bwith )\b(?P<word>{'|'.join(sorted(_COLOURS | _MADE_OF.keys()))})"
    r"(?:[- ]coloured|[- ]colored)?(?: (?:little|small|big|old|used|empty|dirty|round))*"
    r"(?: (?P<noun>[a-z-]+))?$"
)
_WAS = re.compile(r"\bwhere (?:the|that|my|your) \w+ (?:was|were|lay|used to be|had been)\b")
_ON = re.compile(
    r"\b(?:on top of|on|onto|upon|atop|over|with|where) (?:the|that|this|my|your) "
    r"(?P<name>(?:\w+ )?\w+?)"
    r"(?= (?:is|was|are|lies|sits|goes|on|in|and|or|please|now)\b|'s\b|[,;:.?!]|$)"
)

WAS = "is about a place by what was there, which nobody here remembers: say 'on the plate'"


def belied(name: str, thing: str) -> str:
    """The colour or material that a name claims of a thing and that is none of it, "" for none.

    name: of the thing, as it was said. thing: what it is called here.
    """
    told = re.sub(r"\b(?:not|n't|\w+n't|no|without)\b.*", "", name)
    told = re.sub(r"\b(?:one|thing)? ?(?:that|which)(?:'s| is)\b", "", told)
    found = _CLAIM.search(" ".join(words_of(told)))
    if not found:
        return ""
    word = found["word"]
    if word in _MADE_OF:
        return "" if thing in _MADE_OF[word].split() or found["noun"] is None else word
    own = f"{LOOKS[thing]} {_ALSO.get(thing, '')}".split()
    return "" if {word, _ALIASES.get(word, word)} & set(own) else word


def belies(thing: str, claimed: str, command: str) -> str:
    """Why a thing isn't taken that is called what it isn't. command: that takes it."""
    own = LOOKS[thing].split()[0]
    return f"says {claimed!r}, and the {thing} is {own}: if it is meant, say {command!r}"


def put_on(said: str) -> tuple[str, ...]:
    """Things that something is to be put on or to, or where it is to go, as they are named."""
    words = words_of(said)
    row = next((row for row in range(len(words)) if verb_of(words, row) == PUT), None)
    if row is None:
        return ()
    names = (found["name"] for found in _ON.finditer(said))
    return tuple(name for name in names if not PLACES_OF.intersection(words_of(name)))


def was_there(said: str) -> bool:
    """Whether a place is told by what was there."""
    return bool(_WAS.search(said))


def elsewhere(things: Sequence[str], place: str) -> str:
    """Why nothing is put on things that lie elsewhere. place: where it would be put."""
    return (
        f"no {' or '.join(things)} lies there, and things are put on the plate, in bin or tub, "
        f"or down on the table: say {place!r} if that is meant"
    )
