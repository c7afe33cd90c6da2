"""How the versions of the high level came about: rounds, what the gate found, what people ruled."""

from typing import Literal

from shared.messages.message import Id, Message, Step, TimeNs
from shared.messages.policy import Version
from shared.messages.ruling import Ruling

MAX_TOLD = 500
"""Versions, rounds and rulings that are told at most, the newest of each."""


class Share(Message):
    """A share with how many it is of, and its 95 % interval where there is one."""

    share: float
    n: Step
    low: float | None = None
    high: float | None = None


class Compared(Message):
    """The version in force before a round, and what the round made."""

    before: Share
    after: Share


class RoundTold(Message):
    """One turn of DAgger, as it is told.

    parent, made: numbers of the versions that it started from and made.
    episodes, corrections: new since the round before. labels: that it learned from, of all rounds.
    held_out: agreement with labels that it was not trained on. retained: with demonstrations.
    unjudged: why those labels were too few to judge it by; "" where they were enough.
    trials: success in paired episodes of the gate; trials_p: McNemar's p.
    seconds: the training took. promotable: it was held back, and somebody may put it in force.
    """

    number: Step
    epoch: Step
    parent: Step
    made: Step | None = None
    state: Literal["running", "passed", "refused", "failed"]
    episodes: Step = 0
    corrections: Step = 0
    labels: Step | None = None
    held_out: Compared | None = None
    retained: Compared | None = None
    unjudged: str = ""
    trials: Compared | None = None
    trials_p: float | None = None
    seconds: float | None = None
    promotable: bool = False
    reason: str = ""
    begun_ns: TimeNs
    ended_ns: TimeNs | None = None


class VersionTold(Message):
    """One version. round: that made it; again: the number of the one whose weights it has;
    ruling: by which it came about; robots: those that alone run it, none named: all."""

    number: Step
    epoch: Step
    created_ns: TimeNs
    round: Step | None = None
    again: Step | None = None
    ruling: Id | None = None
    robots: tuple[Id, ...] = ()


class RulingTold(Message):
    """A ruling and what became of it; see `Answer` of the learner."""

    ruling: Ruling
    answered_ns: TimeNs | None = None
    made: Step | None = None
    reason: str = ""


class Lineage(Message):
    """All of it, the oldest first; `version` is in force."""

    version: Version
    versions: tuple[VersionTold, ...] = ()
    rounds: tuple[RoundTold, ...] = ()
    rulings: tuple[RulingTold, ...] = ()
