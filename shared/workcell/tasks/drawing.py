"""Draws the part of a wish that all tasks share: which things, and what else lies there."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from shared.workcell.errors import InvalidLength
from shared.workcell.objects import Stock
from shared.workcell.tasks.task import Draw
from shared.workcell.tasks.wishes import Wish, named


@dataclass(frozen=True)
class Constraint:
    """One way to say what fits. text: with braces for what is left out, if anything is.

    but: how many things are left out by name.
    """

    text: str
    traits: tuple[str, ...] = ()
    sides: tuple[str, ...] = ()
    but: int = 0


def check(draw: Draw, name: str, lengths: range) -> None:
    """Refuse a number of skills that a task can't have.

    Raises:
        InvalidLength: it names those that it can.
    """
    if draw.skills is not None and draw.skills not in lengths:
        raise InvalidLength(
            f"a {name} takes {lengths[0]} to {lengths[-1]} skills, an even number; "
            f"got {draw.skills}"
        )


def constrained(rng: np.random.Generator, draw: Draw) -> bool:
    """Whether this prompt shall say what fits; draws nothing where none ever does."""
    return bool(draw.constraints) and rng.random() < draw.constraints


def constrain(
    rng: np.random.Generator,
    choices: Sequence[Constraint],
    things: Sequence[str],
    stock: Stock,
    count: int | None,
) -> tuple[str, Wish, Stock] | None:
    """What to say, and a constraint met by `count` of the things; surplus ones leave the stock.

    count: None: as many as fit. Sides are only asked for where any number will do. None: none of
    the choices is met by so many.
    """
    possible = [choice for choice in choices if _could(choice, things, count)]
    if not possible:
        return None
    choice = possible[int(rng.integers(len(possible)))]
    apt = [name for name in things if Wish((), choice.traits).fits(name)]
    but = tuple(str(name) for name in rng.permutation(apt)[: choice.but])
    wish = Wish((), choice.traits, choice.sides, but)
    fitting = [name for name in apt if name not in but]
    surplus = 0 if count is None else len(fitting) - count
    gone = {str(name) for name in rng.permutation(fitting)[:surplus]}
    return choice.text.format(named(but)) if but else choice.text, wish, stock - gone


def _could(choice: Constraint, things: Sequence[str], count: int | None) -> bool:
    """Whether so many things can fit; of those that are left out by name there is a choice."""
    apt = sum(Wish((), choice.traits).fits(name) for name in things) - choice.but
    return apt >= (count or 1) and not (count and choice.sides)
