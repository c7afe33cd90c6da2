"""The skills of the low level and the words for them: eleven commands, each with paraphrases."""

from dataclasses import dataclass
from typing import Literal

from shared.workcell.errors import UnknownCommand
from shared.workcell.objects import OBJECT_NAMES, index
from shared.workcell.state import CellState, in_bin, on_table, stack_on_plate

Verb = Literal["pick", "plate", "bin", "down", "wait"]

LIFTED_M = 0.100
"""A pick is achieved when the held object is higher than this."""

_TEXTS: dict[Verb, str] = {
    "pick": "pick up the {}",
    "plate": "put it on the plate",
    "bin": "put it in the bin",
    "down": "put it down",
    "wait": "wait",
}


@dataclass(frozen=True)
class Skill:
    """What one command asks for.

    verb: pick, plate, bin, down or wait.
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
    *(Skill(verb) for verb in ("plate", "bin", "down", "wait")),
)
COMMANDS = tuple(skill.text for skill in SKILLS)
"""The canonical commands in their fixed order: seven picks, plate, bin, down, wait."""

PUT_ON_PLATE, PUT_IN_BIN, PUT_DOWN, WAIT = COMMANDS[-4:]
PUTS = frozenset({PUT_ON_PLATE, PUT_IN_BIN, PUT_DOWN})

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


def possible(skill: Skill, state: CellState) -> bool:
    """Whether the skill can be done in this state."""
    return skill.verb in ("pick", "wait") or bool(state.holding)


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
