"""What a name says by kind and colour alone, "the red dish", and on which side its thing lies.

The tellers know what a name is like, and weigh neither of two words that must both hold: "the red
dish" is like the saucer. So a name of nothing but kinds and colours fits what is all of that.
"""

import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shared.goals.family import Floats
from shared.policies.phrase import ACT, ARTICLES, DETERMINERS, THING, words_of
from shared.policies.verbs import PICK, verb_of

NOTHING = "names nothing that is in the scene"
LEAD = 0.05
"""What is less likely by no more than this than the likeliest thing fits as well."""
SHARE = 0.25
"""Where a side is said, so does what has this share of the likeliest."""
_LOOKS = (
    ("bread", "white pale", "food slice"),
    ("toast", "brown", "food slice"),
    ("cheese", "yellow", "food slice"),
    ("ham", "pink", "food slice meat"),
    ("lettuce", "green round", "food slice vegetable"),
    ("tomato", "red round", "food slice vegetable"),
    ("onion", "purple violet round", "food slice vegetable"),
    ("cup", "red", "dish"),
    ("bowl", "blue round", "dish"),
    ("glass", "green", "dish"),
    ("saucer", "white round", "dish"),
    ("can", "red", "rubbish"),
    ("wrapper", "yellow", "rubbish"),
    ("carton", "blue", "rubbish"),
    ("napkin", "white", "rubbish"),
)
"""Of each thing its looks and its kinds, in the order of the rows."""
_SAME = {"rubbish": "trash garbage litter", "vegetable": "veggie veg", "dish": "crockery tableware"}
_KINDS = frozenset(" ".join((*(kinds for *_, kinds in _LOOKS), *_SAME.values())).split())
_FITTING = {
    word: np.array([known in f"{looks} {kinds}".split() for _, looks, kinds in _LOOKS])
    for known in " ".join(f"{looks} {kinds}" for _, looks, kinds in _LOOKS).split()
    for word in (known, *_SAME.get(known, "").split())
}
"""[15] Which things each word fits."""
_ANYTHING = frozenset(("one", "thing", "object", "item", "something", "piece", "bit"))
_SIDE = r"(?:left|right)(?: ?most|-?hand)?"
_NOT_OF_A_THING = r"(?! (?:hand|hands|arm|gripper|place|spot|way|of|away|now|in|on|there|here)\b)"
_SIDED = re.compile(
    rf"\b(?:the|my|your|far|further|furthest|most) ({_SIDE}|leftmost|rightmost)\b{_NOT_OF_A_THING}"
)


class Fit(NamedTuple):
    """The things that a name fits alike. rows: of them. side: "left", "right", or "" for none."""

    rows: tuple[int, ...] = ()
    side: str = ""


def fitting(name: str) -> NDArray[np.bool_] | None:
    """[15] Which things a name fits that says nothing but kind and looks, None for another."""
    told = [word for word in words_of(name) if word not in DETERMINERS | _ANYTHING]
    if not told or not all(word in _FITTING for word in told):
        return None
    fits: NDArray[np.bool_] = np.all([_FITTING[word] for word in told], axis=0)
    return fits


def as_things(words: Sequence[str], parts: Sequence[int]) -> list[int]:
    """The parts, a kind after an article told as a thing: "take the dish" is no act of its own."""
    told = list(parts)
    for at in range(2, len(words)):
        taken = words[at] in _KINDS and words[at - 1] in ARTICLES and verb_of(words, at - 2) == PICK
        if taken and told[at] == ACT:
            told[at - 1 : at + 1] = THING, THING
    return told


def side_of(said: str) -> str:
    """On which side what a phrase names is to lie, "" where it says none."""
    found = _SIDED.search(said)
    return ("left" if found.group(1).startswith("left") else "right") if found else ""


def alike(names: Floats, side: str) -> Fit:
    """The things [15] that a name fits alike, by their probabilities; one if none is near it."""
    most = float(names.max())
    least = SHARE * most if side else most - LEAD
    return Fit(tuple(int(row) for row in np.flatnonzero(names >= max(least, 1e-6))), side)


def among(fit: Fit, commands: Sequence[str]) -> str:
    """Why nothing can be taken where several fit. commands: to take each thing."""
    those = " or ".join(repr(commands[row]) for row in fit.rows)
    aside = f", and none lies clearly further to the {fit.side}" if fit.side else ""
    return f"fits several things{aside}: say {those}"
