"""What a store of the learner must be able to do, and the records that it hands out.

`tests/unit/learner/test_store.py` holds every implementation to it.
"""

from collections.abc import Iterable, Iterator
from enum import StrEnum
from typing import Any, NamedTuple, Protocol

from pydantic import BaseModel, ConfigDict, Field

from shared.messages.correction import Correction
from shared.messages.decision import Decision
from shared.messages.episode import Episode
from shared.messages.policy import TensorRef
from shared.messages.receipt import Receipt
from shared.messages.ruling import Ruling

Kept = Decision | Correction | Receipt | Episode | Ruling


class _Record(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Marks(_Record):
    """How far the tables of arrivals had grown: the number of the last row of each."""

    decisions: int = 0
    corrections: int = 0
    receipts: int = 0
    episodes: int = 0
    rulings: int = 0


class Manifest(_Record):
    """What a round is made from, fixed when it begins: with the seed, it can be made again.

    marks: later arrivals are not part of it. excluded: episodes that had arrived, but not yet
    all of their decisions and corrections; the next round looks at them again.
    settings: of the labels, the training and the gate, as JSON values. code: see `code.py`.
    episodes, corrections: how many of each were new since the round before.
    demonstrations, base, parent: sha256 of the demonstrations, of the store's first version and of
    the one it starts from; "" in records from before this was kept.
    """

    marks: Marks = Marks()
    excluded: tuple[str, ...] = ()
    settings: dict[str, Any] = Field(default_factory=dict)
    code: str = ""
    episodes: int = 0
    corrections: int = 0
    demonstrations: str = ""
    base: str = ""
    parent: str = ""


class RoundState(StrEnum):
    """How far a round came: being trained, published, held back by the gate, or broken off."""

    RUNNING = "running"
    PASSED = "passed"
    REFUSED = "refused"
    FAILED = "failed"


class Round(_Record):
    """One turn of DAgger.

    parent: the number of the version that it started from. made: that of the one that it made.
    epoch: of the learner that began it. figures: what training and gate reported.
    candidate: what the training made, as JSON values; kept from then on, whatever comes of it.
    reason: why it was refused or failed, or what a running one waits for. Times: wall clock, in ns.
    """

    number: int
    epoch: int
    parent: int
    seed: int
    manifest: Manifest
    begun_ns: int
    state: RoundState = RoundState.RUNNING
    figures: dict[str, Any] = Field(default_factory=dict)
    candidate: dict[str, Any] | None = None
    reason: str = ""
    ended_ns: int | None = None
    made: int | None = None


class PolicyRecord(_Record):
    """A version of the high level as it is kept; its tensors lie in `TensorFiles`.

    number: the second half of the version; the first is the epoch of who announces it.
    epoch: of the learner that made it. marks: how far the tables had grown then.
    robots: those that alone are to run it, as a trial; none named: all.
    again: the number of the version whose weights it has again. ruling: the id of what somebody
    decided, if that is how it came about.
    """

    number: int
    epoch: int
    tensors: tuple[TensorRef, ...]
    bank: tuple[str, ...]
    settings: dict[str, int | float | str | bool]
    low_level_sha256: str
    marks: Marks
    created_ns: int
    robots: tuple[str, ...] = ()
    again: int | None = None
    ruling: str = ""


class Answer(_Record):
    """What became of a ruling. made: number of the version put in force. reason: why it is none."""

    ruling: Ruling
    answered_ns: int | None = None
    made: int | None = None
    reason: str = ""


class Trial(_Record):
    """One episode of a gate's evaluation. policy, plan: hashes. row: as `hld evaluate` has it."""

    policy: str
    plan: str
    seed: int
    success: bool
    row: dict[str, Any]


class DecisionHead(NamedTuple):
    """What the labels are derived from: a decision without its pictures.

    executed: the text of the goal in force. best: the text of the first proposal.
    time_ns: when the robot took it, by its clock; None in records of before this was kept.
    """

    id: str
    robot: str
    episode: str
    step: int
    executed: str
    best: str
    chosen_by: str
    time_ns: int | None = None


class History(NamedTuple):
    """Everything that happened, up to a manifest, in no particular order."""

    decisions: tuple[DecisionHead, ...]
    corrections: tuple[Correction, ...]
    receipts: tuple[Receipt, ...]
    episodes: tuple[Episode, ...]
    rulings: tuple[Ruling, ...] = ()


class Arrival(NamedTuple):
    """An episode that no round has used yet, and how complete it is. arrived_ns: wall clock.

    aborted: broken off; its corrections are learned from, but it is not counted. decisions,
    corrections: how many of those it speaks of are missing. overrides: those obeyed, that are here.
    """

    episode: str
    aborted: bool
    arrived_ns: int
    decisions: int
    corrections: int
    overrides: int


class Survey(NamedTuple):
    """What no round has used yet, and how far the tables had grown. hindsight: what was said of the
    past since (`HINDSIGHT`), and what the last round had and was taken back."""

    marks: Marks
    arrivals: tuple[Arrival, ...]
    hindsight: int


class Tally(NamedTuple):
    """What arrived since some marks: episodes but for aborted ones, overrides obeyed, decisions."""

    episodes: int = 0
    successes: int = 0
    corrections: int = 0
    decisions: int = 0


class Store(Protocol):
    """What the learner keeps. Every method may be called from any thread.

    What returned is on the disk: it outlives a crash of the process and of the machine.
    """

    def add(self, message: Kept, now_ns: int) -> bool:
        """Keep a message; False where it was here already.

        Raises:
            RefusedError: another message has this id.
        """
        ...

    def take_over(self, learner: str, now_ns: int) -> int:
        """Become the learner of this store: a new epoch, higher than all before."""
        ...

    def epoch(self) -> int:
        """The epoch of the last learner that took over; 0 before the first."""
        ...

    def tally(self, since: Marks) -> Tally:
        """Count what arrived after `since`."""
        ...

    def survey(self, after: Manifest) -> Survey:
        """The episodes that came after `after`, or that it excluded; in order of arrival."""
        ...

    def history(self, manifest: Manifest) -> History:
        """Everything that `manifest` speaks of."""
        ...

    def decisions(self, ids: Iterable[str]) -> Iterator[Decision]:
        """Whole decisions with their pictures, in the order of `ids`."""
        ...

    def episodes_under(self, number: int) -> tuple[Episode, ...]:
        """All episodes that ran a version, in whichever epoch, in order of arrival."""
        ...

    def begin(self, round_: Round) -> None:
        """Keep a round that begins.

        Raises:
            RefusedError: the epoch is no longer in force, or the round was begun before.
        """
        ...

    def advance(self, round_: Round, version: PolicyRecord | None = None) -> None:
        """Keep how far a running round has come, and what it sends on trial; raises as `end`."""
        ...

    def end(self, round_: Round, version: PolicyRecord | None = None) -> None:
        """Keep how a round ended, together with the version that it made; both or neither.

        A version that was on trial is replaced by `version`, if that has its number.

        Raises:
            RefusedError: the epoch of `version` is no longer in force, the round is not running,
                or the version is there already.
        """
        ...

    def rounds(self) -> tuple[Round, ...]:
        """All rounds, the oldest first."""
        ...

    def found(self, version: PolicyRecord) -> None:
        """Keep the version that a fresh store starts from.

        Raises:
            RefusedError: the store has a version already.
        """
        ...

    def version(self, number: int | None = None) -> PolicyRecord | None:
        """A version by its number; None asks for the one in force, the newest that all run."""
        ...

    def versions(self) -> tuple[PolicyRecord, ...]:
        """All versions, the oldest first."""
        ...

    def answers(self) -> tuple[Answer, ...]:
        """All rulings in order of arrival, with what became of them."""
        ...

    def answer(self, answer: Answer, version: PolicyRecord | None = None) -> None:
        """Keep what became of a ruling, together with the version that it made; both or neither.

        Raises:
            RefusedError: it was answered before, the epoch of `version` is no longer in force, or
                the version is there already.
        """
        ...

    def trials(self, policy: str, plan: str) -> dict[int, Trial]:
        """What was evaluated of a policy in a plan, by seed."""
        ...

    def add_trial(self, trial: Trial) -> bool:
        """Keep one; False where it was here already."""
        ...

    def close(self) -> None:
        """Give everything back; what waits is written first."""
        ...
