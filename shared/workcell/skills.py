"""The skills of the low level and the words for them: twenty commands, each with paraphrases."""

from dataclasses import dataclass
from typing import Literal

from shared.workcell.errors import UnknownCommand
from shared.workcell.objects import BIN, OBJECT_NAMES, PLATE, TUB, index
from shared.workcell.state import CellState, in_bin, in_tub, on_table, stack_on_plate

Verb = Literal["pick", "plate", "bin", "tub", "down", "wait"]

LIFTED_M = 0.100
"""A pick is achieved when the held object is higher than this."""

_TEXTS: dict[Verb, str] = {
    "pick": "pick up the {}",
    "plate": "put it on the plate",
    "bin": "put it in the bin",
    "tub": "put it in the tub",
    "down": "put it down",
    "wait": "wait",
}


@dataclass(frozen=True)
class Skill:
    """What one command asks for.

    verb: pick, plate, bin, tub, down or wait.
    object: name of the object for pick, None otherwise.
    """

    verb: Verb
    object: str | None = None

    @property
    def text(self) -> str:
        """The canonical command."""
        return _TEXTS[self.verb].format(self.object)


SKILLS = (
    *(Skill("pick", name) for name in OBJECT_NAMES),
    *(Skill(verb) for verb in ("plate", "bin", "tub", "down", "wait")),
)
COMMANDS = tuple(skill.text for skill in SKILLS)
"""The canonical commands in their fixed order: fifteen picks, plate, bin, tub, down, wait."""

PUT_ON_PLATE, PUT_IN_BIN, PUT_IN_TUB, PUT_DOWN, WAIT = COMMANDS[-5:]
PUTS = frozenset({PUT_ON_PLATE, PUT_IN_BIN, PUT_IN_TUB, PUT_DOWN})
_FIXTURES: dict[Verb, int] = {"plate": PLATE, "bin": BIN, "tub": TUB}

_BY_TEXT = dict(zip(COMMANDS, SKILLS, strict=True))


def pick(item: int) -> str:
    """The command that picks up the object of this row."""
    return COMMANDS[item]


def parse(text: str) -> Skill:
    """The skill of a canonical command; case and outer spaces don't matter.

    Raises:
        UnknownCommand: no command reads so; the message names the nearest ones.
    """
    skill = _BY_TEXT.get(" ".join(text.lower().split()))
    if skill is None:
        raise UnknownCommand(text, COMMANDS)
    return skill


def obstacle(skill: Skill, state: CellState) -> str:
    """Why the skill can't be done in this state, in a clause; "" where it can."""
    if skill.verb == "wait":
        return ""
    if skill.object is not None:
        there = bool(state.present[index(skill.object)])
        return "" if there else f"there is no {skill.object} here"
    row = _FIXTURES.get(skill.verb)
    if row is not None and not state.present[row]:
        return f"there is no {skill.verb} here"
    return "" if state.holding else "no hand holds anything"


def possible(skill: Skill, state: CellState) -> bool:
    """Whether the skill can be done in this state."""
    return not obstacle(skill, state)


def achieved(skill: Skill, before: CellState, now: CellState) -> bool:
    """Whether the skill, begun in state `before`, is done in state `now`.

    A put is about the objects held in `before`; with empty hands there it is never achieved.
    """
    if skill.verb == "pick" and skill.object is not None:
        item = index(skill.object)
        return item in now.holding and now.points[item][2] > LIFTED_M
    if skill.verb == "wait":
        return now.holding == before.holding
    if not before.holding or now.holding & before.holding:
        return False
    return all(_arrived(skill.verb, item, now) for item in before.holding)


def _arrived(verb: Verb, item: int, state: CellState) -> bool:
    if verb == "plate":
        return stack_on_plate(state)[-1:] == (item,)
    if verb == "bin":
        return item in in_bin(state)
    if verb == "tub":
        return item in in_tub(state)
    return on_table(state, item)


_PICKS = (
    "pick up the {}",
    "grab the {}",
    "take the {}",
    "get the {}",
    "lift the {}",
    "pick the {} up",
    "now the {}",
    "no, the {}",
    "the {} next",
    "get me the {}",
    "you need the {} now",
    "reach for the {}",
)
_NICKNAMES = {
    "bread": ("grab the slice of bread", "take the pale slice of bread"),
    "toast": ("take the slice of toast", "grab the toasted slice"),
    "cheese": ("take the slice of cheese", "grab the yellow slice"),
    "ham": ("take the slice of ham", "grab the pink slice"),
    "lettuce": ("take the lettuce leaf", "grab the salad leaf"),
    "tomato": ("take the slice of tomato", "grab the red slice"),
    "onion": ("take the slice of onion", "grab the onion ring"),
    "cup": ("take the red mug", "grab the red cup"),
    "bowl": ("take the blue bowl", "grab the blue dish"),
    "glass": ("take the green glass", "grab the tumbler"),
    "saucer": ("take the little white plate", "grab the white saucer"),
    "can": ("take the red tin", "grab the empty can"),
    "wrapper": ("take the yellow wrapper", "grab the candy wrapper"),
    "carton": ("take the blue carton", "grab the empty box"),
    "napkin": ("take the white napkin", "grab the paper napkin"),
}

PARAPHRASES: dict[str, tuple[str, ...]] = {
    **{
        f"pick up the {name}": tuple(p.format(name) for p in _PICKS) + _NICKNAMES[name]
        for name in OBJECT_NAMES
    },
    PUT_ON_PLATE: (
        "put it on the plate",
        "place it on the plate",
        "set it on the plate",
        "onto the plate",
        "it goes on the plate",
        "no, on the plate",
        "lay it on the plate",
        "stack it on the plate",
        "put that on top of the stack",
        "now onto the plate with it",
    ),
    PUT_IN_BIN: (
        "put it in the bin",
        "drop it in the bin",
        "place it in the bin",
        "into the bin",
        "it goes in the bin",
        "no, in the bin",
        "put it in the blue box",
        "drop it into the blue bin",
        "pack it into the bin",
        "into the bin with it",
    ),
    PUT_IN_TUB: (
        "put it in the tub",
        "drop it in the tub",
        "place it in the tub",
        "into the tub",
        "it goes in the tub",
        "no, in the tub",
        "put it in the grey tub",
        "put it with the dishes",
        "that belongs in the tub",
        "into the tub with it",
    ),
    PUT_DOWN: (
        "put it down",
        "set it down on the table",
        "put it back",
        "put it back on the table",
        "lay it down",
        "set it down",
        "no, put that down",
        "leave it on the table",
        "not that one, put it down",
        "put it aside",
    ),
    WAIT: (
        "wait",
        "hold still",
        "stop",
        "stay where you are",
        "do nothing",
        "pause",
        "hang on",
        "wait a moment",
        "don't move",
        "that's it, you're done",
    ),
}
"""What people say instead, the canonical command first; for training on language."""
