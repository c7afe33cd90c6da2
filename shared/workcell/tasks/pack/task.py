"""Pack: the named things into the bin, in any order, and nothing else."""

import re

import numpy as np

from shared.workcell import skills
from shared.workcell.errors import UnknownPrompt
from shared.workcell.objects import OBJECT_NAMES, index
from shared.workcell.state import CellState, held_object, in_bin
from shared.workcell.tasks.task import (
    USUAL,
    Brief,
    Draw,
    check,
    listing,
    objects_in,
    put_commands,
    uncovered,
)

FEWEST, MOST = 2, 4
TEMPLATES = (
    "put {} in the bin",
    "pack {} into the bin",
    "please put {} into the blue bin",
    "could you pack {}?",
    "I need {} in the bin, nothing else",
    "tidy {} away into the bin",
    "pack a box with {}",
)
_WORDS = re.compile(r"\b(bin|box|pack)\b")


class Pack:
    """Two to four named things in the bin."""

    name = "pack"
    lengths = range(2 * FEWEST, 2 * MOST + 1, 2)

    def __init__(self, things: int = 3) -> None:
        self._things = things

    def sample(self, rng: np.random.Generator, draw: Draw = USUAL) -> Brief:
        """Draw the things and the words."""
        check(draw, self.name, self.lengths)
        count = draw.skills // 2 if draw.skills else self._things
        things = [str(name) for name in rng.permutation(OBJECT_NAMES)[:count]]
        template = TEMPLATES[int(rng.integers(len(TEMPLATES)))]
        named = listing([f"the {name}" for name in things])
        return Brief(self.name, template.format(named), tuple(things))

    def understand(self, prompt: str) -> Brief:
        """The wish that a sentence expresses."""
        named = objects_in(prompt)
        good = len(set(named)) == len(named) and FEWEST <= len(named) <= MOST
        if not good or not _WORDS.search(prompt.lower()) or "sandwich" in prompt.lower():
            raise UnknownPrompt(
                f"no pack prompt: {prompt!r}; it reads like "
                f"{TEMPLATES[0].format('the cheese and the ham')!r} and names {FEWEST} to {MOST} "
                f"of {', '.join(OBJECT_NAMES)}"
            )
        return Brief(self.name, prompt, named)

    def success(self, state: CellState, brief: Brief) -> bool:
        """The bin holds the named things and no other."""
        return in_bin(state) == frozenset(_rows(brief))

    def progress(self, state: CellState, brief: Brief) -> float:
        """Share of the things in the bin, less the wrong ones there."""
        wish, packed = frozenset(_rows(brief)), in_bin(state)
        return max(0.0, (len(packed & wish) - len(packed - wish)) / len(wish))

    def next_command(self, state: CellState, brief: Brief, previous: str | None) -> str:
        """The right command now: the one in force if it is right, else the prompt's order."""
        return self._commands(state, brief, previous)[0]

    def acceptable_commands(
        self, state: CellState, brief: Brief, previous: str | None
    ) -> frozenset[str]:
        """All commands that are right now."""
        return self._commands(state, brief, previous)[1]

    def _commands(
        self, state: CellState, brief: Brief, previous: str | None
    ) -> tuple[str, frozenset[str]]:
        wish, packed, held = _rows(brief), in_bin(state), held_object(state)
        if held is not None:
            put = skills.PUT_IN_BIN if held in wish else skills.PUT_DOWN
            return put_commands(state, held, put, previous)
        open_items = [*sorted(packed - set(wish)), *(item for item in wish if item not in packed)]
        picks = [skills.pick(uncovered(state, item)) for item in open_items] or [skills.WAIT]
        chosen = previous if previous in picks else picks[0]
        return chosen, frozenset(picks)


def _rows(brief: Brief) -> tuple[int, ...]:
    return tuple(index(name) for name in brief.target)
