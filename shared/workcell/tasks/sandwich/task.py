"""Sandwich: bread, fillings, toast, one upon another on the plate; listed ones in their order."""

import numpy as np

from shared.workcell import skills
from shared.workcell.errors import UnknownPrompt
from shared.workcell.objects import KITCHEN, PLATE, index
from shared.workcell.state import CellState, astray_on_plate, held_object, stack_on_plate
from shared.workcell.tasks import manners
from shared.workcell.tasks.drawing import Constraint, check, constrain, constrained
from shared.workcell.tasks.task import USUAL, Brief, Commanding, Draw, put_commands, uncovered
from shared.workcell.tasks.wishes import EVERYTHING, Wish, listing, read

FILLINGS = ("cheese", "ham", "lettuce", "tomato", "onion")
USUAL_FILLINGS = 2
TEMPLATES = (
    "make a sandwich with {}",
    "I'd like a sandwich with {}, please",
    "build me a sandwich: {}",
    "could you make me a {} sandwich?",
    "a sandwich with {} would be great",
    "please stack a sandwich with {}",
    "one sandwich for the guest: {}",
)
CORES = ("make a sandwich with {}", "stack a sandwich with {}", "make me a sandwich: {}")
CONSTRAINTS = (
    Constraint("a vegetarian sandwich", ("vegetarian",)),
    Constraint("a vegetarian sandwich without {}", ("vegetarian",), but=1),
    Constraint("a sandwich with everything but {}", but=1),
    Constraint("a sandwich with everything, no {}", but=1),
    Constraint("a sandwich with everything except {}", but=2),
    Constraint("a vegetarian sandwich without {}", ("vegetarian",), but=2),
)
VERBS = ("make {}", "make me {}", "build {}")


class Sandwich(Commanding):
    """Bread, up to five fillings, toast."""

    name = "sandwich"
    lengths = range(4, 2 * (len(FILLINGS) + 2) + 1, 2)

    def home(self, item: int) -> int:
        """All goes onto the plate."""
        del item
        return PLATE

    def sample(self, rng: np.random.Generator, draw: Draw = USUAL) -> Brief:
        """Draw the fillings and the words."""
        check(draw, self.name, self.lengths)
        count = None if draw.skills is None else draw.skills // 2 - 2
        if count != 0 and constrained(rng, draw):
            whole = "a sandwich with everything", EVERYTHING, KITCHEN
            said, wish, stock = constrain(rng, CONSTRAINTS, FILLINGS, KITCHEN, count) or whole
            core = VERBS[int(rng.integers(len(VERBS)))].format(said)
            return self._brief(manners.put(core, draw.manner, rng), wish, stock)
        asked = USUAL_FILLINGS if count is None else count
        fillings = [str(name) for name in rng.permutation(FILLINGS)[:asked]]
        cores = TEMPLATES if draw.manner == "plain" else CORES
        core = cores[int(rng.integers(len(cores)))].format(listing(fillings or ["nothing else"]))
        return self.understand(manners.put(core, draw.manner, rng))

    def understand(self, prompt: str) -> Brief:
        """The wish that a sentence expresses."""
        wish = read(prompt)
        text = prompt.lower()
        strange = [name for name in (*wish.names, *wish.but) if name not in FILLINGS]
        twice = len(set(wish.names)) < len(wish.names)
        says = wish.names or wish.constrains or "everything" in text or "nothing else" in text
        if "sandwich" not in text or strange or twice or not says or wish.sides:
            raise UnknownPrompt(
                f"no sandwich prompt: {prompt!r}; it reads like "
                f"{TEMPLATES[0].format('cheese and tomato')!r} or 'make a vegetarian sandwich', "
                f"and names each filling once, of {', '.join(FILLINGS)}"
            )
        return self._brief(prompt, wish, KITCHEN)

    def _brief(self, prompt: str, wish: Wish, stock: frozenset[str]) -> Brief:
        bare = "nothing else" in prompt.lower() and not wish.names
        fillings = () if bare else tuple(n for n in wish.things(stock) if n in FILLINGS)
        target = ("bread", *fillings, "toast")
        return Brief(self.name, prompt, target, wish, bool(wish.names or bare), stock)

    def success(self, state: CellState, brief: Brief) -> bool:
        """The stack is the wish, nothing else is on the plate."""
        stack = stack_on_plate(state)
        whole = _right_from_below(stack, brief) == len(stack) == len(brief.target)
        return whole and not astray_on_plate(state)

    def progress(self, state: CellState, brief: Brief) -> float:
        """Share of the wish that lies in place from the bottom."""
        return _right_from_below(stack_on_plate(state), brief) / len(brief.target)

    def _right(self, state: CellState, brief: Brief, previous: str | None) -> list[str]:
        held = held_object(state)
        wrong, following = _wrong(state, brief), _following(state, brief)
        if held is not None:
            ready = wrong is None and held in following
            put = skills.PUT_ON_PLATE if ready else skills.PUT_DOWN
            return put_commands(state, held, put, previous)
        items = following if wrong is None else [wrong]
        return [skills.pick(uncovered(state, item)) for item in items] or [skills.WAIT]


def _next_layers(stack: tuple[int, ...], brief: Brief) -> list[int]:
    """What may come upon a right stack: the next one, or any filling where order is free."""
    target = [index(name) for name in brief.target]
    if len(stack) >= len(target):
        return []
    if brief.ordered or len(stack) in (0, len(target) - 1):
        return [target[len(stack)]]
    return [item for item in target[1:-1] if item not in stack]


def _right_from_below(stack: tuple[int, ...], brief: Brief) -> int:
    """Length of the longest right beginning."""
    for height, item in enumerate(stack):
        if item not in _next_layers(stack[:height], brief):
            return height
    return len(stack)


def _wrong(state: CellState, brief: Brief) -> int | None:
    """The object that must leave the plate first, None where all on it is right."""
    stack, astray = stack_on_plate(state), astray_on_plate(state)
    if astray:
        return astray[0]
    return stack[-1] if len(stack) > _right_from_below(stack, brief) else None


def _following(state: CellState, brief: Brief) -> list[int]:
    """The objects that may come next on the stack, none when it is complete."""
    stack = stack_on_plate(state)
    return _next_layers(stack[: _right_from_below(stack, brief)], brief)
