"""A phrase that was understood, weighed in its scene: the command that it means, or why none."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from shared.goals.family import Floats
from shared.policies.reader.claims import belied, belies
from shared.policies.reader.clauses import AGAINST
from shared.policies.reader.located import ARM, SIDED
from shared.policies.reader.looks import NAMES, NOTHING, Fit, alike, among
from shared.policies.reader.meant import LEAST_ACT, PLACES, PUTS, THINGS, WAIT_ROW, Reading, Taken
from shared.policies.reader.ranked import RANKED

LEAST_NAME = 0.3
"""A thing or place that is named is refused where it is less probable."""


class Scale:
    """Weighs phrases by what can be said.

    commands: their texts. known: the thing that a name is known as, None for none.
    """

    def __init__(self, commands: Sequence[str], known: Callable[[str], int | None]) -> None:
        self._commands, self._known = commands, known

    def __call__(self, taken: Taken, there: NDArray[np.bool_], can: NDArray[np.bool_]) -> Reading:
        """there: [18] bool, what is in the scene. can: [C] bool, what is about nothing missing."""
        parts = taken.parts
        acts, names, things = taken.told(there, len(self._commands))
        scores = acts * names
        best = int(scores.argmax())
        sure = acts[best] >= LEAST_ACT and names[best] >= LEAST_NAME
        idle = parts.idle if best != WAIT_ROW else ""
        fixed = "" if sure and (best >= THINGS or can[best]) else _fixed(parts.things, there)
        nothing = "" if all(thing.any() for thing in things) else NOTHING
        why = parts.why or idle or nothing or fixed
        if why in AGAINST:
            scores[best] = 0.0
        fit = alike(names[:THINGS], parts.side, parts.two)
        if not why and acts[0] >= LEAST_ACT and len(fit.rows) > 1:  # It is to take something.
            those = among(fit, self._commands)
            if parts.ranked or parts.arm:
                those, fit = f"{RANKED if parts.ranked else ARM}; it {those}", Fit()
            if parts.ranked or names[[*fit.rows]].sum() >= LEAST_ACT:
                return Reading(None, scores, things, those, fit=fit)
        why = why or self._false(taken, things, best if sure else None)
        command = best if sure and not why else None
        return Reading(command, scores, things, why, parts.first, arm=parts.arm, onto=taken.onto)

    def _false(self, taken: Taken, things: Sequence[Floats], best: int | None) -> str:
        """What is wrong with a phrase that was read as a command, or as none; "" for nothing."""
        parts = taken.parts
        if best is not None and best < THINGS and parts.arm:
            return ARM
        if parts.ranked and not things:
            return RANKED
        for name, told in zip(parts.things, things, strict=True):
            row = int(told.argmax())
            claimed = belied(name, NAMES[row]) if told[row] >= LEAST_NAME else ""
            if claimed and self._known(name) != row:
                return belies(NAMES[row], claimed, self._commands[row])
        several = any(len(alike(told, parts.side).rows) > 1 for told in things)
        return SIDED if best in PUTS and parts.side and several else ""


def _fixed(things: Sequence[str], there: NDArray[np.bool_]) -> str:
    """Why a place that is named for a thing can't be taken, "" where none is."""
    here = [name for at, name in enumerate(PLACES[:-1], THINGS) if there[at]]
    named = next((name for name in here if name in things), "")
    return f"can't be done: nobody here can take the {named}" if named else ""
