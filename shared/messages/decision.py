"""One query of the high level: the unit that is shown, corrected and learned from."""

from typing import Annotated, Self

from pydantic import Field, JsonValue, model_validator

from shared.messages.goal import Goal
from shared.messages.message import Id, Message, Step, Text, TimeNs
from shared.messages.observation import OBSERVATION_ARRAYS
from shared.messages.policy import Version


class Proposal(Message):
    """A goal that the high level considered, with its score (a probability)."""

    goal: Goal
    score: Annotated[float, Field(ge=0, le=1)]


class Decision(Message):
    """One query of the high level: what it saw, what it proposed, what was done.

    Kept by the actor until the learner has it; never changed afterwards.

    index: the how-manieth decision of its episode, from 0.
    step: the control step at which the high level looked.
    prompt, previous: as in `Observation`.
    proposed: goals with their scores, best first.
    executed: the goal in force after this query, before anybody had a chance to object to it.
    chosen_by: the policy version ("1.3"), or the id of the correction that was holding.
    awaits_verdict: the robot stands still until a supervisor approves or corrects (lockstep).
    truth: the simulator's account of the scene for scripted people; real robots leave it empty.
    arrays: as in `Observation`.

    Source: Ross et al. 2011 (arXiv 1011.0686) for the pair (s, π*(s)); unlike there, only a
    decision that somebody corrected or approved carries an expert's label
    (cf. arXiv 2403.12910).
    """

    ARRAYS = OBSERVATION_ARRAYS

    id: Id
    robot: Id
    episode: Id
    index: Step
    step: Step
    time_ns: TimeNs
    task: Id
    prompt: Text
    previous: tuple[Text, ...] = ()
    proposed: tuple[Proposal, ...] = Field(min_length=1)
    executed: Goal
    chosen_by: str
    version: Version
    awaits_verdict: bool = False
    truth: dict[str, JsonValue] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _check_order(self) -> Self:
        scores = [proposal.score for proposal in self.proposed]
        if scores != sorted(scores, reverse=True):
            raise ValueError("proposed must be ordered, best first")
        return self
