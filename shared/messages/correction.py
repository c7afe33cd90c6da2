"""What a person (or the scripted oracle) says instead; it never changes, a later one may
supersede it."""

from collections.abc import Mapping, Set
from enum import StrEnum
from typing import Annotated, Self

from pydantic import Field, model_validator

from shared.messages.goal import Goal
from shared.messages.message import Id, Message, Step, Text, TimeNs


class Kind(StrEnum):
    """What a correction asks of the robot, or says afterwards (`AFTERWARDS`).

    override: obey this goal instead, until it expires, is released, replaced, or the episode ends.
    release: the goal that holds is lifted; the high level decides again.
    approve: the command that was in force at the decision was right.
    pass: seen, nothing to say: a robot that waits for a verdict goes on. Never a label.
    pause, resume: stand still; carry on. Never a label. A pause is never too late, nor too early:
        it counts in whatever episode comes.
    retract: the target should not have been said.
    edit: the target should have been said in these words.
    retime: the target should have been in force over these steps.
    relabel: over these steps this goal would have been right.
    fault: the command was right, the hand slipped: nothing that the high level could learn.
    endorse: over these steps the high level was right wherever nobody said anything else.
    """

    OVERRIDE = "override"
    RELEASE = "release"
    APPROVE = "approve"
    PASS = "pass"
    PAUSE = "pause"
    RESUME = "resume"
    RETRACT = "retract"
    EDIT = "edit"
    RETIME = "retime"
    RELABEL = "relabel"
    FAULT = "fault"
    ENDORSE = "endorse"

    @property
    def answers(self) -> bool:
        """It answers a robot that calls for help: something was said about what it does now."""
        return self in (Kind.OVERRIDE, Kind.RELEASE, Kind.APPROVE, Kind.PASS)


AMENDMENTS = frozenset({Kind.RETRACT, Kind.EDIT, Kind.RETIME})
"""Said about another correction, the target."""
AFTERWARDS = AMENDMENTS | {Kind.RELABEL, Kind.FAULT, Kind.ENDORSE}
"""Said about what has happened, so that an episode that is over is none too late for them."""

HINDSIGHT = frozenset({Kind.EDIT, Kind.RELABEL, Kind.RETIME})
"""Said about the past, and something new to learn, in episodes that may have been learned from."""

LEARNABLE = frozenset(Kind) - {Kind.PASS, Kind.PAUSE, Kind.RESUME, Kind.RETRACT, Kind.FAULT}
"""May become a label of the high level, or change one."""

TARGETS: dict[Kind, frozenset[Kind]] = {
    Kind.RETRACT: frozenset(Kind) - {Kind.RETRACT, Kind.PASS, Kind.PAUSE, Kind.RESUME},
    Kind.EDIT: frozenset({Kind.OVERRIDE, Kind.RELABEL}),
    Kind.RETIME: frozenset({Kind.OVERRIDE, Kind.RELABEL, Kind.FAULT, Kind.ENDORSE}),
}
"""What each amendment may be about. Of several edits or retimes of one correction the last counts,
unless it was retracted in its turn; what was taken back is to be said again."""

NEEDS: dict[Kind, frozenset[str]] = {
    Kind.OVERRIDE: frozenset({"goal"}),
    Kind.RETRACT: frozenset({"target"}),
    Kind.EDIT: frozenset({"goal", "target"}),
    Kind.RETIME: frozenset({"target", "first_step", "end_step"}),
    Kind.RELABEL: frozenset({"goal", "first_step", "end_step"}),
    Kind.ENDORSE: frozenset({"first_step", "end_step"}),
}
"""The fields without which a kind says nothing."""
_LIVE = frozenset({"decision"})
ALLOWS: dict[Kind, frozenset[str]] = {
    Kind.OVERRIDE: _LIVE | {"hold_steps"},
    Kind.FAULT: _LIVE | {"first_step", "end_step"},
    **{kind: _LIVE for kind in Kind if kind not in AFTERWARDS | {Kind.OVERRIDE}},
}
"""The fields that a kind may have besides; of all that stand in `BOUND`, no other."""
BOUND = ("goal", "target", "first_step", "end_step", "hold_steps", "decision")


def check_fields(kind: Kind, given: Set[str], names: Mapping[str, str] | None = None) -> None:
    """Hold the fields that were given against what a kind of correction needs and allows.

    names: what a caller calls a field, where that is something else.

    Raises:
        ValueError: one is missing or too many; the message says what the kind has.
    """
    needs, allows = NEEDS.get(kind, frozenset()), ALLOWS.get(kind, frozenset())

    def told(fields: Set[str]) -> str:
        listed = [(names or {}).get(name, name) for name in BOUND if name in fields]
        return " and ".join(listed) or "none of its own"

    if missing := needs - given:
        raise ValueError(f"{kind} needs {told(needs)}; missing: {told(missing)}")
    if surplus := given - needs - allows:
        raise ValueError(f"{kind} has no {told(surplus)}; it has {told(needs | allows)}")


def check_span(kind: Kind, first: int | None, end: int | None, decision: str | None) -> None:
    """Hold a stretch of control steps against what can be meant.

    Raises:
        ValueError: it has one end only or no step, or a fault names neither a stretch nor a
            decision.
    """
    if (first is None) != (end is None):
        raise ValueError("first_step and end_step go together: the steps from one up to the other")
    if first is not None and end is not None and end <= first:
        raise ValueError(f"end_step is the first step after the stretch, so more than {first}")
    if kind is Kind.FAULT and first is None and decision is None:
        raise ValueError("a fault needs decision, or first_step and end_step: where it happened")


MAX_SPEAKING_S = 120.0
"""Who takes longer to say something did something else meanwhile."""


def speaking_s(begun_ns: int, created_ns: int) -> float:
    """Human seconds of one correction: from when a person began to speak to when it was said.

    At most `MAX_SPEAKING_S`; 0 where the clocks of the two disagree. This is the one definition.
    """
    return min(max(0.0, (created_ns - begun_ns) / 1e9), MAX_SPEAKING_S)


class Correction(Message):
    """One utterance of a person about one robot.

    Three times are kept, since they differ: what the person saw (`seen_step`), when they began
    to speak (`begun_ns`), and when it took effect (`Receipt.step`).

    episode: the episode that it is about; the actor refuses it when that episode is over, but for
        a pause and for what is said afterwards.
    decision: the decision that the person was looking at, where there is one.
    goal: what to do instead, or what should have been done: of override, edit and relabel.
    target: the id of the correction that a retract, an edit or a retime is about.
    first_step, end_step: the control steps [first, end) that a retime, a relabel, a fault or an
        endorsement is about; a fault without them is about its decision.
    hold_steps: control steps after which an override expires; None holds until released.
    delay_steps: in supervised lockstep, the steps between seeing and taking effect; 0 otherwise.
    begun_ns: when the person began to speak or type; created_ns: when the API accepted it.
    heard: where it was spoken, the words as a recogniser heard them; None: typed or chosen.
    """

    id: Id
    robot: Id
    episode: Id
    kind: Kind
    author: Id
    goal: Goal | None = None
    decision: Id | None = None
    target: Id | None = None
    first_step: Step | None = None
    end_step: Step | None = None
    seen_step: Step | None = None
    hold_steps: Annotated[int, Field(ge=1, le=100_000)] | None = None
    delay_steps: Annotated[int, Field(ge=0, le=10_000)] = 0
    begun_ns: TimeNs
    created_ns: TimeNs
    heard: Text | None = None
    note: Text | None = None

    @model_validator(mode="after")
    def _check_kind(self) -> Self:
        check_fields(self.kind, {name for name in BOUND if getattr(self, name) is not None})
        check_span(self.kind, self.first_step, self.end_step, self.decision)
        return self

    @property
    def span(self) -> range | None:
        """The control steps that it names itself."""
        if self.first_step is None or self.end_step is None:
            return None
        return range(self.first_step, self.end_step)
