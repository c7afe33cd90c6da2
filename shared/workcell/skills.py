"""The skills of the low level and the words for them: twenty commands."""

from dataclasses import dataclass
from typing import Literal

from shared.workcell.errors import UnknownCommand
from shared.workcell.objects import BODY_NAMES, OBJECT_NAMES, index
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

ATTEMPT_STEPS = 120
"""Control steps that one attempt at a skill may take."""

PUT_ON_PLATE, PUT_IN_BIN, PUT_IN_TUB, PUT_DOWN, WAIT = COMMANDS[-5:]
PUTS = frozenset({PUT_ON_PLATE, PUT_IN_BIN, PUT_IN_TUB, PUT_DOWN})

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


def is_there(skill: Skill, state: CellState) -> bool:
    """Whether the thing, or the place, that the skill is about is in the cell."""
    name = skill.object or skill.verb
    return name not in BODY_NAMES or bool(state.present[BODY_NAMES.index(name)])


def possible(skill: Skill, state: CellState) -> bool:
    """Whether the skill can be done in this state; something must be held to be put."""
    free = skill.verb in ("pick", "wait") or bool(state.holding)
    return free and is_there(skill, state)


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
