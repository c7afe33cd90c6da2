"""What the oracle sees of a decision: the API's JSON, as any client would read it."""

from typing import Any

from pydantic import BaseModel, ConfigDict

from shared.errors import HldError


class UnclearError(HldError):
    """The API answered with something else than was asked for."""


class Command(BaseModel):
    """A goal in words."""

    text: str


class Proposed(BaseModel):
    """What the policy considered."""

    goal: Command
    score: float


class Call(BaseModel):
    """A call for help. waits_s: for how much longer the robot stands still; 0: it goes on."""

    waits_s: float


class Seen(BaseModel):
    """A decision as a person sees it, plus the truth, which no person has.

    executed: the command in force, chosen by a policy version or by a correction's id.
    help: the robot's call for help, if one is open.
    previous: the commands before, oldest first. proposed: what else was considered, best first.
    """

    model_config = ConfigDict(frozen=True)

    id: str
    robot: str
    episode: str
    index: int
    step: int
    task: str
    prompt: str
    previous: tuple[str, ...]
    proposed: tuple[Proposed, ...]
    executed: Command
    chosen_by: str
    awaits_verdict: bool
    help: Call | None = None
    truth: dict[str, Any]

    @property
    def waits(self) -> bool:
        """The robot stands still for a while until somebody helps."""
        return self.help is not None and self.help.waits_s > 0


def parse(content: bytes) -> Seen:
    """Read the API's answer.

    Raises:
        UnclearError: it is no decision.
    """
    try:
        return Seen.model_validate_json(content)
    except ValueError as error:
        raise UnclearError(f"this is no decision: {error}") from None
