"""What a phrase was taken for without its scene; and how probable each command is in one."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shared.goals.family import Floats
from shared.policies.reader.located import PIECE
from shared.policies.reader.looks import Fit, fitting
from shared.policies.reader.phrase import Parts, likened, unlike
from shared.policies.reader.teller import softmax

ACTS = ("pick", "put", "plate", "bin", "tub", "down", "wait", "refuse")
"""What a phrase may ask for; to put something somewhere is told further by the place."""
PLACES = ("plate", "bin", "tub", "down")
THINGS = 15
PUTS = THINGS + np.arange(len(PLACES))  # Rows of the commands that put, in the order of PLACES.
WAIT_ROW = THINGS + len(PLACES)
LEAST_ACT = 0.5
"""What is to be done is refused where it is less probable."""
ABSENT = 2.0
"""By so much less likely, in logits, a thing is meant that isn't in the scene."""


class Reading(NamedTuple):
    """What a phrase was taken for.

    command: row of the command, None where it was refused. scores: [C] float32 in [0, 1], of each
    command its probability. things: of each thing that it names how probable each of the [15] is.
    why: what is wrong with a phrase, if it is more than that it wasn't understood.
    first: what it says to do before. fit: the things that it fits alike, if they are several.
    arm: the one that is to do it, "" for any. onto: of each thing that it is to be put on, [15]
    bool, which that may be.
    """

    command: int | None
    scores: Floats
    things: tuple[Floats, ...] = ()
    why: str = ""
    first: str = ""
    fit: Fit = Fit()
    arm: str = ""
    onto: tuple[NDArray[np.bool_], ...] = ()


class Taken(NamedTuple):
    """A phrase as understood without its scene: logits of acts [8], of each thing [15 + 1] and
    each place [4 + 1] that it names. parts: of what. onto: as in `Reading`."""

    acts: Floats
    things: tuple[Floats, ...]
    places: tuple[Floats, ...]
    parts: Parts
    onto: tuple[NDArray[np.bool_], ...] = ()

    def told(
        self, there: NDArray[np.bool_], count: int
    ) -> tuple[Floats, Floats, tuple[Floats, ...]]:
        """[count] each: how probable each command's act is, and then its thing or place; and of
        each thing that is named how probable each of the [15] is. there: [18], in the scene."""
        told = dict(zip(ACTS, softmax(self.acts), strict=True))
        missing = np.append(np.where(there[:THINGS], 0.0, ABSENT), 0.0).astype(np.float32)
        things = tuple(
            softmax(logits - missing)[:THINGS] if fits is None else _alike(fits & there[:THINGS])
            for logits, fits in zip(self.things, map(self._fitting, self.parts.things), strict=True)
        )
        acts, names = np.ones((2, count), np.float32)
        acts[:THINGS] = told["pick"]
        names[:THINGS] = agreed(things, THINGS)
        places = agreed([softmax(logits)[: len(PLACES)] for logits in self.places], len(PLACES))
        put, without_place = told["put"], np.array([told[place] for place in PLACES])
        if self.places:  # To let go of something in a place is to put it there.
            put, without_place[-1] = put + told["down"], 0.0
        acts[PUTS] = put + without_place
        known = min((float(thing.sum()) for thing in things), default=1.0)
        names[PUTS] = known * (put * places + without_place) / acts[PUTS]
        acts[WAIT_ROW] = told["wait"]
        return acts, names, things

    def _fitting(self, thing: str) -> NDArray[np.bool_] | None:
        """[15] Which things a name fits that has only kinds and looks; by its side any may be
        meant."""
        return np.ones(THINGS, np.bool_) if self.parts.side and thing == PIECE else fitting(thing)


def _alike(fits: NDArray[np.bool_]) -> Floats:
    """[15] All that fits is as probable."""
    chances: Floats = fits.astype(np.float32) / np.float32(max(1, int(fits.sum())))
    return chances


def agreed(named: Sequence[Floats], count: int) -> Floats:
    """[count] What all that is named may be, each [count]; nothing, if nothing is named."""
    if not named:
        return np.zeros(count, np.float32)
    least: Floats = np.min(np.stack(named), axis=0)
    return least


def excluded(thing: str, told: Mapping[str, Floats]) -> bool:
    """Whether it is told as what it is said not to be: "one that isn't ham" is like the ham, but
    "cup without a handle" is a cup whatever it lacks. told: logits [15 + 1] by text."""
    other, itself = unlike(thing), likened(thing)
    row = int(told[thing].argmax())
    if not other or row == THINGS or softmax(told[other])[row] < LEAST_ACT:
        return False
    return not itself or softmax(told[itself])[row] < LEAST_ACT
