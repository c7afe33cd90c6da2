"""One attempt at one task, told when it is over."""

from enum import StrEnum

from pydantic import Field

from shared.messages.decision import Asked
from shared.messages.message import Id, Message, Step, Text, TimeNs
from shared.messages.policy import Version


class Outcome(StrEnum):
    """How an episode ended: the task done, time run out, or broken off (not to be counted)."""

    SUCCESS = "success"
    TIMEOUT = "timeout"
    ABORTED = "aborted"


class Episode(Message):
    """One attempt at one task.

    number: the how-manieth episode of its robot since the robot's store began.
    seed: what the scene was drawn from; `shared/seeds.py` says which seeds are for what.
    version: the high level that ran all of it. low_level_sha256: the low level that did.
    steps, decisions, corrections: how many there were; corrections counts overrides only.
    asked: how many of the decisions there were for each reason to ask the high level; empty in
        records from before this was told.
    """

    id: Id
    robot: Id
    number: Step
    task: Id
    prompt: Text
    site: Id
    seed: Step
    version: Version
    low_level_sha256: str
    outcome: Outcome
    steps: Step
    decisions: Step
    corrections: Step
    asked: dict[Asked, Step] = Field(default_factory=dict)
    started_ns: TimeNs
    ended_ns: TimeNs

    @property
    def success(self) -> bool:
        """The task was done when the episode ended."""
        return self.outcome is Outcome.SUCCESS
