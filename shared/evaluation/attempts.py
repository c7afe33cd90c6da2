"""What happened in an episode, as it is kept: attempts at skills, and what failed first."""

from pydantic import BaseModel, ConfigDict

from shared.workcell.errors import UnknownCommand
from shared.workcell.skills import Skill, parse

SKILL_NAMES = {
    "pick": "pick up",
    "plate": "put on the plate",
    "bin": "put in the bin",
    "tub": "put in the tub",
    "down": "put down",
}
"""Skills as reports call them, by their verb. To wait is none: it has no end to be achieved."""


class _Kept(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Attempt(_Kept):
    """A stretch of one command in force, from its begin to its end.

    command: as it was said. skill: its name in reports; "" if no skill reads so, or it is to wait.
    begin: the first control step. steps: until it was achieved, else until it ended.
    wrong: decisions that put it in force, or kept it there, although it was not right.
    """

    command: str
    skill: str
    success: bool
    begin: int
    steps: int
    wrong: int = 0

    @property
    def flawless(self) -> bool:
        """Both levels did their part: it was achieved, and right to say as long as it was said."""
        return self.success and not self.wrong


class Row(_Kept):
    """One episode of an evaluation.

    progress: how much of what the task asks for was in place at the end, in [0, 1].
    asked: decisions by why π_HL was asked. wrong: decisions that put in force, or kept there, what
    was not right at that moment.
    failure: what went wrong first, in an episode that failed; failed_step: when.
    diverged: steps of physics that were taken back; see `Cell.diverged`.
    """

    seed: int
    task: str
    prompt: str
    success: bool
    progress: float
    steps: int
    decisions: int
    asked: dict[str, int] = {}
    wrong: int = 0
    failure: str = ""
    failed_step: int = -1
    diverged: int = 0
    attempts: tuple[Attempt, ...] = ()
    low_level_sha256: str


def skill_of(text: str) -> Skill | None:
    """The skill of a canonical command; None for other words."""
    try:
        return parse(text)
    except UnknownCommand:
        return None


def skill_name(skill: Skill | None) -> str:
    """How reports call it; "" for what is no attempt."""
    return SKILL_NAMES.get(skill.verb, "") if skill else ""
