"""What people call things, skills and places, and what no robot here can do; and how it is split.

The words lie in `words/*.toml` as groups of what shares a word. What is marked with "?", a tenth
that was drawn once, is the exam: no reader that is shipped was taught it. The rest falls into five
folds, and a fold is what a reader of the other four has never heard. The first group of a list,
with the canonical word if it has one, is always known.
"""

import tomllib
from functools import cache
from importlib import resources
from typing import Any, NamedTuple

import numpy as np

FOLDS = 5
MARK = "?"
"""Begins what is kept for the exam."""

Group = tuple[str, ...]
Table = dict[str, tuple[Group, ...]]


class Lexicon(NamedTuple):
    """One side of a split: groups of phrases.

    things: by name what they are called. acts: by verb what is said for it; `{}` is a thing, `[]` a
    place. places: by fixture, "down" for the table, "other" for the rest of the world. others:
    "things", "acts" (`{}`: a thing) and "said", to be refused. courtesy: "before", "after",
    "beside", "contrast" (`{x}`: not this, `{n}`: this), "places" (the same of where to), "two"
    things at once, "about" (`{}`: a thing that is remarked on before it is asked for).
    """

    things: Table
    acts: Table
    places: Table
    others: Table
    courtesy: Table


def exam() -> tuple[Lexicon, Lexicon]:
    """What a reader that is shipped is taught, and what it never heard."""
    return _split(None, 0)


def fold(number: int, seed: int) -> tuple[Lexicon, Lexicon]:
    """What is taught and what was never heard in one fold of cross-validation, without the exam.

    Raises:
        ValueError: there is no such fold.
    """
    if not 0 <= number < FOLDS:
        raise ValueError(f"there are folds 0 to {FOLDS - 1}, not {number}")
    return _split(number, seed)


def _split(number: int | None, seed: int) -> tuple[Lexicon, Lexicon]:
    """Number None: the exam against the rest; else that fold against the other folds."""
    shuffle = np.random.default_rng(seed)
    known: list[Table] = []
    unheard: list[Table] = []
    for table in _read():
        known.append({})
        unheard.append({})
        for name, lines in table.items():
            taught = [row for row, line in enumerate(lines) if not line.startswith(MARK)]
            rest = shuffle.permutation(taught[1:])
            kept = set(range(len(lines))) - set(taught)
            new = kept if number is None else set(rest[number::FOLDS].tolist())
            old = [row for row in taught if row not in new]
            known[-1][name] = tuple(_group(lines[row]) for row in old)
            unheard[-1][name] = tuple(_group(lines[row]) for row in sorted(new))
    return Lexicon(*known), Lexicon(*unheard)


@cache
def _read() -> tuple[dict[str, list[str]], ...]:
    """The tables of a lexicon, whole."""
    acts = _load("acts")
    places = acts.pop("places")
    return _load("things"), acts, places, _load("others"), _load("courtesy")


def _group(line: str) -> Group:
    return tuple(part.strip() for part in line.removeprefix(MARK).split("|"))


def _load(name: str) -> dict[str, Any]:
    folder = resources.files("services.learner.pretrain").joinpath("words")
    return tomllib.loads(folder.joinpath(f"{name}.toml").read_text())
