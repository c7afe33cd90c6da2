"""Pack: the named or fitting food into the bin, in any order, and nothing else."""

import re

import numpy as np

from shared.workcell.errors import UnknownPrompt
from shared.workcell.objects import BIN, KINDS, KITCHEN
from shared.workcell.tasks import manners
from shared.workcell.tasks.drawing import Constraint, check, constrain, constrained
from shared.workcell.tasks.sorting import Sorting
from shared.workcell.tasks.task import USUAL, Brief, Draw
from shared.workcell.tasks.wishes import named, read

FOOD = KINDS["food"]
USUAL_THINGS = 3
TEMPLATES = (
    "put {} in the bin",
    "pack {} into the bin",
    "please put {} into the blue bin",
    "could you pack {}?",
    "I need {} in the bin, nothing else",
    "tidy {} away into the bin",
    "pack a box with {}",
)
CORES = ("put {} in the bin", "pack {} into the bin", "tidy {} away into the bin")
CONSTRAINTS = (
    Constraint("everything but {}", but=1),
    Constraint("all the food except {}", but=2),
    Constraint("everything vegetarian", ("vegetarian",)),
    Constraint("everything vegetarian but {}", ("vegetarian",), but=1),
    Constraint("everything brown", ("brown",)),
    Constraint("everything red", ("red",)),
    Constraint("everything green", ("green",)),
    Constraint("only what is on the left", sides=("left",)),
    Constraint("only what is on the right", sides=("right",)),
    Constraint("everything on the left but {}", sides=("left",), but=1),
)
_WORDS = re.compile(r"\b(bin|box|pack)\b")


class Pack(Sorting):
    """One to seven things in the bin."""

    name = "pack"
    lengths = range(2, 2 * len(FOOD) + 1, 2)

    def home(self, item: int) -> int:
        """All goes into the bin."""
        del item  # Unused.
        return BIN

    def sample(self, rng: np.random.Generator, draw: Draw = USUAL) -> Brief:
        """Draw the things and the words."""
        check(draw, self.name, self.lengths)
        count = None if draw.skills is None else draw.skills // 2
        if constrained(rng, draw) and (drawn := constrain(rng, CONSTRAINTS, FOOD, KITCHEN, count)):
            said, wish, stock = drawn
            core = CORES[int(rng.integers(len(CORES)))].format(said)
            prompt = manners.put(core, draw.manner, rng)
            return Brief(self.name, prompt, wish.things(stock), wish, False, stock)
        things = [str(name) for name in rng.permutation(FOOD)[: count or USUAL_THINGS]]
        cores = TEMPLATES if draw.manner == "plain" else CORES
        core = cores[int(rng.integers(len(cores)))].format(named(things))
        return self.understand(manners.put(core, draw.manner, rng))

    def understand(self, prompt: str) -> Brief:
        """The wish that a sentence expresses."""
        wish = read(prompt)
        things = wish.things(KITCHEN)
        twice = len(set(wish.names)) < len(wish.names)
        missing = [name for name in wish.names if name not in KITCHEN]
        if missing or twice or not things or not _WORDS.search(prompt.lower()):
            raise self._unknown(prompt)
        if "sandwich" in prompt.lower() or not (wish.names or wish.constrains):
            raise self._unknown(prompt)
        return Brief(self.name, prompt, things, wish, False, KITCHEN)

    def _unknown(self, prompt: str) -> UnknownPrompt:
        return UnknownPrompt(
            f"no pack prompt: {prompt!r}; it reads like "
            f"{TEMPLATES[0].format('the cheese and the ham')!r} or "
            f"{CORES[0].format('everything vegetarian')!r}, and names each thing once, "
            f"of {', '.join(FOOD)}"
        )
