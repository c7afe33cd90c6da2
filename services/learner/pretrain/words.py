"""What people call things and skills: phrases to know, and phrases that are kept for tests.

Every fourth word of `words.toml`, drawn by a fixed seed, is kept aside: nouns for the things,
sentences for the puts, and what no robot of this cell can do. A test phrase is made of at least one
word that was kept aside; the canonical commands are always known.
"""

import tomllib
from functools import cache
from importlib import resources
from itertools import product
from typing import NamedTuple

import numpy as np

from shared.workcell.skills import SKILLS, Skill

KEPT = 4
"""One in so many words is kept for tests."""
BEFORE = ("no, {}", "please {}", "{}, please", "now {}", "could you {}?", "{} now", "ok, {}")
COMMON = 6
SEED = 1


class Words(NamedTuple):
    """The words of one side of the split.

    things: by name its nouns. frames: by verb its sentences. other: what is to be refused: whole
    sentences, things, places.
    """

    things: dict[str, tuple[str, ...]]
    frames: dict[str, tuple[str, ...]]
    other: dict[str, tuple[str, ...]]


@cache
def split() -> tuple[Words, Words]:
    """The words that are known, and those that are kept for tests."""
    text = resources.files("services.learner.pretrain").joinpath("words.toml").read_text()
    table = tomllib.loads(text)
    rng = np.random.default_rng(SEED)
    both: tuple[list[dict[str, tuple[str, ...]]], ...] = ([], [])
    for part in (table["things"], table["frames"], table["other"]):
        pairs = {name: _cut(words, rng) for name, words in part.items()}
        for side in (0, 1):
            both[side].append({name: pair[side] for name, pair in pairs.items()})
    known, kept = (Words(things, frames, other) for things, frames, other in both)
    return known, kept


def _cut(words: list[str], rng: np.random.Generator) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The first one, the canonical word, is always known."""
    kept = {int(row) for row in 1 + rng.permutation(len(words) - 1)[: len(words) // KEPT]}
    known = tuple(word for row, word in enumerate(words) if row not in kept)
    return known, tuple(words[row] for row in sorted(kept))


def known_phrases() -> list[list[str]]:
    """For each command what the reader is taught, the canonical command first.

    Of a pick every noun in some sentences and every sentence with some nouns: the rest follows.
    """
    known, _ = split()
    told = []
    for skill in SKILLS:
        if skill.object is None:
            said = list(known.frames[skill.verb])
        else:
            frames, nouns = known.frames[skill.verb], known.things[skill.object]
            pairs = [*product(frames[:COMMON], nouns), *product(frames[COMMON:], nouns[:COMMON])]
            said = [frame.format(noun) for frame, noun in pairs]
        told.append(list(dict.fromkeys([skill.text, *said])))
    return told


def refused_phrases() -> list[str]:
    """What the reader is taught to refuse."""
    return _refusable(split()[0])


def _refusable(words: Words) -> list[str]:
    """Sentences, unknown things in known frames, unknown places."""
    frames = split()[0].frames["pick"][:COMMON]
    things = [frames[row % COMMON].format(noun) for row, noun in enumerate(words.other["things"])]
    things += [
        frames[(row + 2) % COMMON].format(it) for row, it in enumerate(words.other["things"])
    ]
    return [*words.other["said"], *things, *(f"put it {place}" for place in words.other["places"])]


class Unheard(NamedTuple):
    """A phrase that was never taught. new: what in it is: "noun", "verb" or "both"."""

    phrase: str
    new: str


def unheard_phrases() -> list[list[Unheard]]:
    """For each command phrases with words that were kept aside, in an order drawn once.

    Of picks a third each has a new noun, a new verb, both; half of all have a word of courtesy or
    protest before or after.
    """
    known, kept = split()
    rng, told = np.random.default_rng(SEED), []
    for skill in SKILLS:
        new = {"verb": _phrases(skill, known, kept)}
        if skill.object:
            new |= {"noun": _phrases(skill, kept, known), "both": _phrases(skill, kept, kept)}
        drawn = [[Unheard(str(it), kind) for it in rng.permutation(new[kind])] for kind in new]
        least = min(map(len, drawn))
        turns = [unheard for row in range(least) for unheard in (kind[row] for kind in drawn)]
        told.append([_dressed(one, row) for row, one in enumerate(turns)])
    return told


def unheard_refusals() -> list[str]:
    """What must be refused and was never heard."""
    return _refusable(split()[1])


def _phrases(skill: Skill, things: Words, frames: Words) -> list[str]:
    said = frames.frames[skill.verb]
    if skill.object is None:
        return list(said)
    return [frame.format(noun) for frame, noun in product(said, things.things[skill.object])]


def _dressed(unheard: Unheard, row: int) -> Unheard:
    """Every other one with something said before or after."""
    if row % 2:
        return unheard
    frame = BEFORE[row // 2 % len(BEFORE)]
    return unheard._replace(phrase=frame.format(unheard.phrase))
