"""Questions, which ask for no act: "is the ham in the bin?", "cup?"."""

import re

from shared.policies.reader.phrase import ACT, CONTRAST, FILLER, PARTS, PLACE, THING, words_of
from shared.policies.reader.verbs import PUT
from shared.policies.reader.wording import Words

_AUXILIARY = frozenset(words_of("is are was were did does has had am do have should shall"))
SUBJECTS = frozenset(words_of("i we you they he she it that this the there"))
_ONLY_PEOPLE = {"do": "i we you they", "have": "i we you they", "shall": "i", "should": "i we you"}
_ASKING = re.compile(r"(?:who|what|where|when|why|how|which|whose)(?:'s|'re|'d)?")
_KINDLY = frozenset(("mind", "able", "possible", "chance", "think", "could", "would", "please"))
_SUGGESTING = frozenset(
    words_of("please maybe perhaps about how why could can would kindly next instead")
)
_GOING = frozenset(("goes", "belongs", "should", "needs"))


def asks(phrase: Words, rows: range) -> bool:
    """Whether it is a question that asks for no act."""
    told = [phrase.words[row] for row in rows if phrase.parts[row] != FILLER]
    if _only_names(phrase, rows):
        return True
    if len(told) < 2 or _KINDLY.intersection(phrase.words[row] for row in rows):
        return False
    first, second = told[:2]
    if first in _AUXILIARY:
        return second in _ONLY_PEOPLE.get(first, " ".join(SUBJECTS)).split()
    if first in ("can", "could", "may", "might", "must"):
        return second == "i" and any(phrase.verb(row) == PUT for row in rows)
    if not _ASKING.fullmatch(first):
        return False
    about = _AUXILIARY.union(("goes", "put")) if first != "who" else {second}
    said = _GOING.intersection(told[2:]) or phrase.acts(rows)
    done = second in ("did", "do", "does", "has", "have", "put") or first == "who"
    return (second in about or "'" in first) and (done or not said)


def _only_names(phrase: Words, rows: range) -> bool:
    """Whether it is a name with a question mark, "cup?", and courtesy at most."""
    asked = phrase.said.rstrip().endswith("?") and rows.stop == len(phrase.words)
    polite = _SUGGESTING.intersection(phrase.words)
    named = [row for row in rows if phrase.parts[row] in (THING, PLACE, CONTRAST)]
    return (
        asked
        and not polite
        and bool(named)
        and not any(phrase.parts[row] == ACT or phrase.verb(row, PARTS) for row in rows)
    )
