"""What a name says by kind and colour alone, "the red dish", and on which side its thing lies.

The tellers know what a name is like, and weigh neither of two words that must both hold: "the red
dish" is like the saucer. So a name of nothing but kinds and colours fits what is all of that.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shared.goals.family import Floats
from shared.policies.reader.phrase import ACT, ARTICLES, DETERMINERS, THING, words_of
from shared.policies.reader.verbs import PICK, verb_of

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
NAMES = tuple(name for name, *_ in _LOOKS)
LOOKS = {name: looks for name, looks, _ in _LOOKS}
"""Of each thing the words for its colour, the first one first."""
_SAME = {"rubbish": "trash garbage litter", "vegetable": "veggie veg", "dish": "crockery tableware"}
KINDS = frozenset(" ".join((*(kinds for *_, kinds in _LOOKS), *_SAME.values())).split())
_FITTING = {
    word: np.array([known in f"{looks} {kinds}".split() for _, looks, kinds in _LOOKS])
    for known in " ".join(f"{looks} {kinds}" for _, looks, kinds in _LOOKS).split()
    for word in (known, *_SAME.get(known, "").split())
}
"""[15] Which things each word fits."""
ANYTHING = frozenset(("one", "thing", "object", "item", "something", "piece", "bit"))


class Fit(NamedTuple):
    """The things that a name fits alike. rows: of them. side: "left", "right", or "" for none;
    two: that side only because what is meant is not on the other, which tells one of two."""

    rows: tuple[int, ...] = ()
    side: str = ""
    two: bool = False


def fitting(name: str) -> NDArray[np.bool_] | None:
    """[15] Which things a name fits that says nothing but kind and looks, None for another."""
    told = [word for word in words_of(name) if word not in DETERMINERS | ANYTHING]
    if not told or not all(word in _FITTING for word in told):
        return None
    fits: NDArray[np.bool_] = np.all([_FITTING[word] for word in told], axis=0)
    return fits


def as_things(words: Sequence[str], parts: Sequence[int]) -> list[int]:
    """The parts, a kind after an article told as a thing: "take the dish" is no act of its own."""
    told = list(parts)
    for at in range(2, len(words)):
        taken = words[at] in KINDS and words[at - 1] in ARTICLES and verb_of(words, at - 2) == PICK
        if taken and told[at] == ACT:
            told[at - 1 : at + 1] = THING, THING
    return told


def alike(names: Floats, side: str, two: bool = False) -> Fit:
    """The things [15] that a name fits alike, by their probabilities; one if none is near it."""
    most = float(names.max())
    least = SHARE * most if side else most - LEAD
    return Fit(tuple(int(row) for row in np.flatnonzero(names >= max(least, 1e-6))), side, two)


def among(fit: Fit, commands: Sequence[str]) -> str:
    """Why nothing can be taken where several fit. commands: to take each thing."""
    those = " or ".join(repr(commands[row]) for row in fit.rows)
    aside = f", and none lies clearly further to the {fit.side}" if fit.side else ""
    if fit.two and len(fit.rows) > 2:
        aside = ", and not to be on a side tells one only of two"
    return f"fits several things{aside}: say {those}"
