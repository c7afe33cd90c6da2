"""What a person (or the scripted oracle) says instead; it never changes, a later one may
supersede it."""

from enum import StrEnum
from typing import Annotated, Self

from pydantic import Field, model_validator

from shared.messages.goal import Goal
from shared.messages.message import Id, Message, Step, Text, TimeNs


class Kind(StrEnum):
    """What a correction asks of the robot.

    override: obey this goal instead, until it expires, is released, replaced, or the episode ends.
    release: the goal that holds is lifted; the high level decides again.
    approve: the command that was in force at the decision was right.
    pass: seen, nothing to say: a robot that waits for a verdict goes on. Never a label.
    pause, resume: stand still; carry on. Never a label.
    """

    OVERRIDE = "override"
    RELEASE = "release"
    APPROVE = "approve"
    PASS = "pass"
    PAUSE = "pause"
    RESUME = "resume"

    @property
    def answers(self) -> bool:
        """It answers a robot that calls for help, which standing still and carrying on don't."""
        return self not in (Kind.PAUSE, Kind.RESUME)


class Correction(Message):
    """One utterance of a person about one robot.

    Three times are kept, since they differ: what the person saw (`seen_step`), when they began
    to speak (`begun_ns`), and when it took effect (`Receipt.step`).

    episode: the episode that it is about; the actor refuses it when that episode is over.
    decision: the decision that the person was looking at, where there is one.
    goal: what to do instead; only `override` has one.
    hold_steps: control steps after which an override expires; None holds until released.
    delay_steps: in supervised lockstep, the steps between seeing and taking effect; 0 otherwise.
    begun_ns: when the person began to speak or type; created_ns: when the API accepted it.
    """

    id: Id
    robot: Id
    episode: Id
    kind: Kind
    author: Id
    goal: Goal | None = None
    decision: Id | None = None
    seen_step: Step | None = None
    hold_steps: Annotated[int, Field(ge=1, le=100_000)] | None = None
    delay_steps: Annotated[int, Field(ge=0, le=10_000)] = 0
    begun_ns: TimeNs
    created_ns: TimeNs
    note: Text | None = None

    @model_validator(mode="after")
    def _check_goal(self) -> Self:
        if (self.goal is not None) != (self.kind is Kind.OVERRIDE):
            raise ValueError("an override has a goal, and no other kind of correction has one")
        if self.hold_steps is not None and self.kind is not Kind.OVERRIDE:
            raise ValueError("only an override has hold_steps")
        return self
