"""What ranks things or tells them by others, taken out of a phrase: "the second dish".

Nobody here counts or compares: what remains must be one thing by itself.
"""

import re

from shared.policies.reader.looks import ANYTHING, KINDS, NAMES
from shared.policies.reader.phrase import words_of
from shared.policies.reader.verbs import PUT, verb_of

RANKED = "ranks things or tells them by what lies beside, and only names, colours and sides count"
HEADS = frozenset((*NAMES, *KINDS, *ANYTHING))
DET = r"(?:the|my|your|our|that|this|a|any)"
A_HEAD = rf"(?:{'|'.join(sorted(HEADS))})"
_ORDINAL = (
    r"(?:first|second|third|fourth|fifth|sixth|\d(?:st|nd|rd|th)|last|middle|centre|center|central|"
    r"(?!left|right)\w{2,}est|(?:far|fur|far)?thermost|bigger|larger|smaller|taller|shorter|nearer|"
    r"closer|further|farther|heavier|lighter|wider|narrower|thicker|thinner)"
)
_FROM_SIDE = re.compile(
    rf"\b((?:{DET} )?){_ORDINAL} ((?:\w+ )?)({A_HEAD}\b)? ?(?:in )?"
    r"from (?:the|your|my) (?:left|right)\b"
)
_RANKED = re.compile(
    rf"\b((?:(?:{DET}|one of the) )?)(?:two |\w+ ?most )?{_ORDINAL} (?=(?:\w+ )?{A_HEAD}\b)"
)
_RELATED = re.compile(
    rf"\b({A_HEAD}) (?:(?:that|which)(?:'s| is| lies| sits| stands) |lying |sitting |standing )?"
    r"(?:right |just )?(?:next to|beside|near to|near|nearest to|nearest|closest to|closest|"
    r"close to|by|behind|in front of|between|under|underneath|beneath|above|opposite|"
    r"(?:on |to )?(?:the )?(?:left|right) of|in the (?:middle|centre|center)(?: of)?|"
    r"at the (?:front|back|top|bottom)(?: of)?)"
    rf"(?: (?:{DET}) (?:\w+ )?{A_HEAD}\b| {DET} \w+| me\b| you\b|(?= |$|,))"
)


def unranked(said: str) -> str:
    """A phrase without what ranks things; where something is put, beside another is a place."""
    text = said if puts(said) else _RELATED.sub(r"\1", _FROM_SIDE.sub(r"\1\2\3", said))
    return tidy(_RANKED.sub(r"\1", text))


def puts(said: str) -> bool:
    """Whether a verb that puts something is in it."""
    words = words_of(said)
    return any(
        verb_of(words, row) == PUT and not (row and words[row - 1] in ("the", "a", "that", "dirty"))
        for row in range(len(words))
    )


def tidy(text: str) -> str:
    """Single spaces, and none before a stop."""
    return re.sub(r" (?=[,;:.?!])", "", " ".join(text.split()))
