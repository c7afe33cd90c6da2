"""Bus: clear the table, dishes into the tub and rubbish into the bin, or the part that is asked."""

import re

import numpy as np

from shared.workcell.errors import UnknownPrompt
from shared.workcell.objects import BIN, KINDS, OBJECTS, TABLE, TUB
from shared.workcell.tasks import manners
from shared.workcell.tasks.drawing import Constraint, check, constrain, constrained
from shared.workcell.tasks.sorting import Sorting
from shared.workcell.tasks.task import USUAL, Brief, Draw
from shared.workcell.tasks.wishes import EVERYTHING, read

THINGS = KINDS["dish"] + KINDS["rubbish"]
USUAL_THINGS = 6
CORES = ("clear the table", "bus the table", "clear everything from the table")
CONSTRAINED = ("clear away {}", "clear {} from the table", "bus the table, {}")
CONSTRAINTS = (
    Constraint("only the dishes", ("dish",)),
    Constraint("only the rubbish", ("rubbish",)),
    Constraint("only the dishes but not {}", ("dish",), but=1),
    Constraint("everything but {}", but=1),
    Constraint("all except {}", but=2),
    Constraint("everything red", ("red",)),
    Constraint("everything blue", ("blue",)),
    Constraint("everything white", ("white",)),
    Constraint("only what is on the left", sides=("left",)),
    Constraint("only what is on the right", sides=("right",)),
)
_VERBS = re.compile(r"\b(bus|clear|clean|cleared)\b")


class Bus(Sorting):
    """One to eight things off the table."""

    name = "bus"
    lengths = range(2, 2 * len(THINGS) + 1, 2)

    def home(self, item: int) -> int:
        """Dishes go to the tub, rubbish to the bin."""
        return TUB if OBJECTS[item].kind == "dish" else BIN

    def sample(self, rng: np.random.Generator, draw: Draw = USUAL) -> Brief:
        """Draw what lies there, and the words."""
        check(draw, self.name, self.lengths)
        count = None if draw.skills is None else draw.skills // 2
        if constrained(rng, draw) and (drawn := constrain(rng, CONSTRAINTS, THINGS, TABLE, count)):
            said, wish, stock = drawn
            core = CONSTRAINED[int(rng.integers(len(CONSTRAINED)))].format(said)
        else:
            gone = [str(name) for name in rng.permutation(THINGS)[count or USUAL_THINGS :]]
            wish, stock = EVERYTHING, TABLE - set(gone)
            core = CORES[int(rng.integers(len(CORES)))]
        prompt = manners.put(core, draw.manner, rng)
        return Brief(self.name, prompt, wish.things(stock), wish, False, stock)

    def understand(self, prompt: str) -> Brief:
        """The wish that a sentence expresses, all things lying there."""
        wish = read(prompt)
        things = wish.things(TABLE)
        strange = [name for name in (*wish.names, *wish.but) if name not in TABLE]
        if strange or not things or not _VERBS.search(prompt.lower()):
            raise UnknownPrompt(
                f"no bus prompt: {prompt!r}; it reads like {CORES[0]!r} or "
                f"{CONSTRAINED[0].format('only the dishes')!r}, about {', '.join(THINGS)}"
            )
        return Brief(self.name, prompt, things, wish, False, TABLE)
