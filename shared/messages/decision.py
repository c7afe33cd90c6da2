"""One query of the high level: the unit that is shown, corrected and learned from."""

import math
from collections.abc import Sequence
from enum import StrEnum
from itertools import pairwise
from typing import Annotated, Self

from pydantic import Field, JsonValue, model_validator

from shared.messages.goal import Goal
from shared.messages.help import Help
from shared.messages.message import Id, Message, Step, Text, TimeNs
from shared.messages.observation import OBSERVATION_ARRAYS
from shared.messages.policy import Version


class Proposal(Message):
    """A goal that the high level considered, with its score (a probability)."""

    goal: Goal
    score: Annotated[float, Field(ge=0, le=1)]


class Asked(StrEnum):
    """Why the high level was asked.

    start: an episode begins. interval: it was time. completion: the low level says that the
    command is achieved. stuck: one command was in force for long without being achieved.
    interjection: a person said something. expiry: a person's word has run out.
    """

    START = "start"
    INTERVAL = "interval"
    COMPLETION = "completion"
    STUCK = "stuck"
    INTERJECTION = "interjection"
    EXPIRY = "expiry"


class Choice(StrEnum):
    """How the goal in force follows from what was proposed.

    best: the first proposal. held: a person's word holds, whatever is proposed. objection: the low
    level objects to what was proposed before it, or to all, and what was in force stays. smoothed:
    it is best in the mean of the last looks. hysteresis: no other was more probable by the margin.
    dwell: it had not been in force for long enough.
    """

    BEST = "best"
    HELD = "held"
    OBJECTION = "objection"
    SMOOTHED = "smoothed"
    HYSTERESIS = "hysteresis"
    DWELL = "dwell"


def entropy(proposals: Sequence[Proposal]) -> float:
    """How undecided a high level is, in nats: at least so much.

    Scores that sum to less than 1 leave a rest for goals that are not among the proposals; each of
    those counts as no more probable than the last that is, which holds as far as the most
    probable ones were proposed: a beam search may miss one.
    """
    scores = [proposal.score for proposal in proposals if proposal.score > 0]
    known = -sum(score * math.log(score) for score in scores)
    rest = 1.0 - sum(scores)
    if rest <= 1e-9:
        return abs(known)
    return known - rest * math.log(min([rest, *scores]))


class Decision(Message):
    """One query of the high level: what it saw, what it proposed, what was done.

    Kept by the actor until the learner has it; never changed afterwards.

    index: the how-manieth decision of its episode, from 0.
    step: the control step at which the high level looked.
    asked: why the high level was asked; None in records from before this was told.
    prompt, previous: as in `Observation`.
    past: indices of the earlier decisions of this episode whose pictures were shown too, oldest
        first.
    proposed: goals with their scores, best first.
    executed: the goal in force after this query, before anybody had a chance to object to it.
    chosen_by: the policy version ("1.3") or, where a person's word held, the id of the correction.
    choice: how that follows from `proposed`; None in records from before this was told.
    awaits_verdict: the robot stands still until a supervisor approves or corrects (lockstep).
    help: the call for help that is open at this query, where there is one; it began here if it
        names this decision.
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
    asked: Asked | None = None
    task: Id
    prompt: Text
    previous: tuple[Text, ...] = ()
    past: tuple[Step, ...] = ()
    proposed: tuple[Proposal, ...] = Field(min_length=1)
    executed: Goal
    chosen_by: str
    choice: Choice | None = None
    version: Version
    awaits_verdict: bool = False
    help: Help | None = None
    truth: dict[str, JsonValue] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _check_order(self) -> Self:
        scores = [proposal.score for proposal in self.proposed]
        if scores != sorted(scores, reverse=True):
            raise ValueError("proposed must be ordered, best first")
        indices = (*self.past, self.index)
        if any(one >= other for one, other in pairwise(indices)):
            raise ValueError("past must name earlier decisions, oldest first")
        return self

    @property
    def entropy(self) -> float:
        """How undecided the high level was, in nats; at least, as `entropy` says."""
        return entropy(self.proposed)

    @property
    def margin(self) -> float:
        """By how much the best proposal is more probable than the next one; 1 if it is alone."""
        first, *others = (proposal.score for proposal in self.proposed)
        return first - others[0] if others else 1.0
