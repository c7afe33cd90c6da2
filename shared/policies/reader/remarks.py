"""Remarks beside an order: "it rolled off. Get the can". What is left of a phrase without them."""

import re
from collections.abc import Sequence
from typing import NamedTuple

from shared.policies.reader.phrase import words_of

_STOPS = re.compile(r"[,.;:!?]+\s+|\s+-+\s+|\s+(?=so (?!that))")
INTERJECTIONS = frozenset(
    words_of(
        "hmm hm um uh erm er ah oh ooh ow ouch whoops oops well so now right okay ok look listen "
        "no nope yes yeah yep eww ew yuck ugh phew gosh blimey crikey wow please sorry hey "
        "love hon mate pal chef robot dear darling duck sir actually kiddo cowboy "
        "partner boss lad lass buddy son there"
    )
)
_ABOUT = frozenset(
    words_of(
        "i i'm i've i'd i'll we we're we've you you've you're he he's she she's they they're "
        "they've it it's it'll that that's this there there's here's someone somebody nobody "
        "everyone everybody someone's somebody's my our his her their the too still not one none"
    )
)
"""A clause that begins so and says how things are is none to obey."""
_BESIDE = frozenset(words_of("as like because since too still before while pretty looks seems"))
"""A clause that begins so is none either, whatever it says."""
_STATES = re.compile(
    r"(?:is|are|was|were|has|have|had|am|will|went|fell|left|ate|drank|took|got|did|broke|spilt|"
    r"forgot|made|came|ran|knew|saw|thought|looks|seems|\w+'s|\w+'ll|\w+'ve|\w+'re|\w+n't|\w{2,}ed)"
)
_WISHES = frozenset(words_of("need needs want wants goes belongs should must please"))
_VAGUE = frozenset(words_of("something some more somewhere space room"))
"""To want these is no order."""


class Clauses(NamedTuple):
    """orders: what may be obeyed, in a row. remarks: the rest, clause by clause."""

    orders: str
    remarks: tuple[str, ...]


def set_apart(said: str) -> Clauses:
    """A phrase, as it is spelt, without the clauses that only tell how things are."""
    clauses = [clause for clause in _STOPS.split(said) if words_of(clause)]
    remarks = [is_remark(words_of(clause)) for clause in clauses]
    kept = [clause for clause, remark in zip(clauses, remarks, strict=True) if not remark]
    told = [clause for clause, remark in zip(clauses, remarks, strict=True) if remark]
    return Clauses(", ".join(kept), tuple(told))


def is_remark(words: Sequence[str]) -> bool:
    """Whether a clause of these words tells how things are, or only calls."""
    start = next((at for at, word in enumerate(words) if word not in INTERJECTIONS), len(words))
    told = words[start:]
    if not told or told[0] in _BESIDE or (len(told) == 1 and told[0].endswith("ly")):
        return True
    if told[0].endswith("'s") and len(told) <= 4 and told[0] not in _ABOUT:
        return True  # "Bin's full".
    if told[0] not in _ABOUT:
        return False
    if _WISHES.intersection(told):
        return not _VAGUE.isdisjoint(told)
    return _states(told)


def _states(told: Sequence[str]) -> bool:
    """Whether its verb says how things are: "it fell over", "it tears easily"."""
    of_one = told[0] in ("it", "he", "she") and told[1:2] and told[1].endswith("s")
    return bool(of_one) or any(map(_STATES.fullmatch, told))
