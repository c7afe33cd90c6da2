"""Sandwich: bread, the fillings in the order named, toast, one upon another on the plate."""

import numpy as np

from shared.workcell import skills
from shared.workcell.errors import UnknownPrompt
from shared.workcell.objects import OBJECT_NAMES, index
from shared.workcell.state import CellState, astray_on_plate, held_object, stack_on_plate
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

FILLINGS = ("cheese", "ham", "lettuce", "tomato", "onion")
MOST_FILLINGS = 3
TEMPLATES = (
    "make a sandwich with {}",
    "I'd like a sandwich with {}, please",
    "build me a sandwich: {}",
    "could you make me a {} sandwich?",
    "a sandwich with {} would be great",
    "please stack a sandwich with {}",
    "one sandwich for the guest: {}",
)


class Sandwich:
    """Bread, one to three fillings in the prompt's order, toast."""

    name = "sandwich"
    lengths = range(6, 2 * (MOST_FILLINGS + 2) + 1, 2)

    def __init__(self, fillings: int = 2) -> None:
        self._fillings = fillings

    def sample(self, rng: np.random.Generator, draw: Draw = USUAL) -> Brief:
        """Draw the fillings and the words."""
        check(draw, self.name, self.lengths)
        count = draw.skills // 2 - 2 if draw.skills else self._fillings
        fillings = [str(name) for name in rng.permutation(FILLINGS)[:count]]
        template = TEMPLATES[int(rng.integers(len(TEMPLATES)))]
        return self._brief(template.format(listing(fillings)), fillings)

    def understand(self, prompt: str) -> Brief:
        """The wish that a sentence expresses."""
        named = objects_in(prompt)
        good = len(set(named)) == len(named) and 1 <= len(named) <= MOST_FILLINGS
        if "sandwich" not in prompt.lower() or not good or not set(named) <= set(FILLINGS):
            raise UnknownPrompt(
                f"no sandwich prompt: {prompt!r}; it reads like "
                f"{TEMPLATES[0].format('cheese and tomato')!r} and names 1 to {MOST_FILLINGS} of "
                f"{', '.join(FILLINGS)}"
            )
        return self._brief(prompt, list(named))

    def success(self, state: CellState, brief: Brief) -> bool:
        """The stack is the wish, nothing else is on the plate."""
        return stack_on_plate(state) == _rows(brief) and not astray_on_plate(state)

    def progress(self, state: CellState, brief: Brief) -> float:
        """Share of the wish that lies in place from the bottom."""
        return _right_from_below(stack_on_plate(state), _rows(brief)) / len(brief.target)

    def next_command(self, state: CellState, brief: Brief, previous: str | None) -> str:
        """The right command now."""
        return self._commands(state, brief, previous)[0]

    def acceptable_commands(
        self, state: CellState, brief: Brief, previous: str | None
    ) -> frozenset[str]:
        """All commands that are right now."""
        return self._commands(state, brief, previous)[1]

    def _brief(self, prompt: str, fillings: list[str]) -> Brief:
        return Brief(self.name, prompt, ("bread", *fillings, "toast"))

    def _commands(
        self, state: CellState, brief: Brief, previous: str | None
    ) -> tuple[str, frozenset[str]]:
        target, held = _rows(brief), held_object(state)
        wrong, following = _wrong(state, target), _following(state, target)
        if held is not None:
            ready = wrong is None and held == following
            put = skills.PUT_ON_PLATE if ready else skills.PUT_DOWN
            return put_commands(state, held, put, previous)
        if wrong is None and following is None:
            return skills.WAIT, frozenset({skills.WAIT})
        item = wrong if wrong is not None else following
        assert item is not None  # one of the two is something
        command = skills.pick(uncovered(state, item))
        return command, frozenset({command})


def _rows(brief: Brief) -> tuple[int, ...]:
    return tuple(index(name) for name in brief.target)


def _right_from_below(stack: tuple[int, ...], target: tuple[int, ...]) -> int:
    """Length of the longest common beginning."""
    same = [a == b for a, b in zip(stack, target, strict=False)]
    return same.index(False) if False in same else len(same)


def _wrong(state: CellState, target: tuple[int, ...]) -> int | None:
    """The object that must leave the plate first, None where all on it is right."""
    stack, astray = stack_on_plate(state), astray_on_plate(state)
    if astray:
        return astray[0]
    return stack[-1] if len(stack) > _right_from_below(stack, target) else None


def _following(state: CellState, target: tuple[int, ...]) -> int | None:
    """The object that comes next on the stack, None when it is complete."""
    done = _right_from_below(stack_on_plate(state), target)
    return target[done] if done < len(target) else None


assert set(FILLINGS) < set(OBJECT_NAMES)
