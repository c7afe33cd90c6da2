"""One turn of DAgger at work: train, gate, by setting some robots first, then all.

Every stage is on the disk before the next one begins, so that a learner that takes over goes on
there and trains or tries nothing twice.
"""

import dataclasses
from collections.abc import Callable
from typing import Protocol

import structlog

from services.learner import canary
from services.learner.collect import Collector
from services.learner.descent import descent
from services.learner.frozen import FrozenLowLevel
from services.learner.gate import Candidate, Gate, Verdict
from services.learner.lessons import Lessons
from services.learner.publish import Publisher
from services.learner.store.store import Manifest, PolicyRecord, Round, RoundState, Store
from shared.clock import Clock
from shared.errors import FrozenError, PolicyError
from shared.messages.heartbeat import LearnerState
from shared.wire.bus import Bus

WATCH_NS = 1_000_000_000


class Trainer(Protocol):
    """Trains one round at a time, beside the learner's own thread."""

    def demonstrations(self) -> str:
        """Hash of the demonstrations that a round would learn from; "" where it can't be told."""
        ...

    def start(self, round_: Round) -> None:
        """Begin to train; returns at once."""
        ...

    def progress(self) -> float:
        """How far it is, 0 to 1."""
        ...

    def result(self) -> Candidate | None:
        """What came of it, once; None while it is at work.

        Raises:
            PolicyError: nothing came of it; the reason is in the text.
        """
        ...

    def stop(self) -> None:
        """Give up what is being trained, if anything is."""
        ...

    def forget(self, round_: Round) -> None:
        """Throw away what is kept of a training that is over."""
        ...


@dataclasses.dataclass(frozen=True)
class Parts:
    """What a learner is made of; `build.py` chooses them."""

    bus: Bus
    store: Store
    collector: Collector
    trainer: Trainer
    gate: Gate
    publisher: Publisher
    frozen: FrozenLowLevel
    lessons: Lessons
    clock: Clock


class Turn:
    """A round from where it stands to its end.

    round: as it is kept. made: the version that it put in force for all, once it has.
    stopped: why no further round may begin; "" where nothing speaks against it.
    """

    def __init__(
        self,
        parts: Parts,
        settings: canary.CanarySettings,
        epoch: int,
        in_force: PolicyRecord,
        round_: Round,
    ) -> None:
        self._parts, self._settings, self._epoch = parts, settings, epoch
        self._in_force = in_force
        self._began_ns = self._looked_ns = parts.clock.monotonic_ns()
        self._log = structlog.get_logger()
        self._step: Callable[[], None] = self._train
        self.round, self.stopped = round_, ""
        self.made: PolicyRecord | None = None

    @property
    def over(self) -> bool:
        """It has ended, well or not."""
        return self.round.state is not RoundState.RUNNING

    @property
    def state(self) -> LearnerState:
        """What it does."""
        training = self.round.candidate is None
        return LearnerState.TRAINING if training else LearnerState.JUDGING

    def progress(self) -> float:
        """How far its stage is, 0 to 1."""
        if self.round.candidate is None:
            return self._parts.trainer.progress()
        return self._parts.gate.progress()

    def begin(self) -> None:
        """Start, or go on with what a learner before has done."""
        self._log.info("a round begins", round=self.round.number, parent=self.round.parent)
        try:
            self._parts.frozen.check()
            if self.round.made is not None:
                self._go_on_watching(self.round.made)
            elif self.round.candidate is not None:
                self._judge(Candidate.model_validate(self.round.candidate))
            else:
                self._parts.trainer.start(self.round)
        except PolicyError as error:
            self._fail(error)

    def follow(self) -> None:
        """One look at what is at work; never waits for long."""
        try:
            self._step()
        except PolicyError as error:
            self._fail(error)

    def abandon(self, reason: str) -> None:
        """End it, since something else was put in force."""
        self._parts.trainer.stop()
        self._parts.gate.stop()
        self._end(RoundState.FAILED, reason)

    # -- the stages

    def _train(self) -> None:
        candidate = self._parts.trainer.result()
        if candidate is None:
            return
        self._parts.frozen.check()
        self.round = self.round.model_copy(
            update={
                "candidate": candidate.model_dump(mode="json"),
                "figures": candidate.figures.model_dump(mode="json"),
            }
        )
        self._parts.store.advance(self.round)
        self._judge(candidate)

    def _judge(self, candidate: Candidate) -> None:
        records = self._record(candidate), self._in_force
        announced, in_force = self._parts.publisher.offer(self._epoch, *records)
        self._step = self._try
        if verdict := self._parts.gate.begin(candidate, announced, in_force):
            self._conclude(verdict)

    def _try(self) -> None:
        if verdict := self._parts.gate.poll():
            self._conclude(verdict)

    def _conclude(self, verdict: Verdict) -> None:
        found = {"trials": verdict.figures, "unjudged": verdict.unjudged}
        figures = {**self.round.figures, **{name: one for name, one in found.items() if one}}
        self.round = self.round.model_copy(update={"figures": figures})
        if not verdict.passed:
            self._end(RoundState.REFUSED, verdict.reason)
            return
        made = self._record(Candidate.model_validate(self.round.candidate))
        self.round = self.round.model_copy(update={"made": made.number})
        if not self._settings.robots:
            self._admit(made)
            return
        first = made.model_copy(update={"robots": self._settings.robots})
        self._parts.store.advance(self.round, first)
        self._publish(first)
        self._began_ns = self._parts.clock.monotonic_ns()
        self._step = self._watch

    def _watch(self) -> None:
        """While some robots run it first; episodes last longer than the time between two looks."""
        store, number, now = self._parts.store, self.round.made, self._parts.clock.monotonic_ns()
        assert number is not None  # It was made before it was watched.
        if now - self._looked_ns < WATCH_NS:
            return
        self._looked_ns, waited_s = now, (now - self._began_ns) / 1e9
        mine = [one for one in store.episodes_under(number) if one.robot in self._settings.robots]
        before = [one for alike in self._same_weights() for one in store.episodes_under(alike)]
        finding = canary.judge(mine, before, waited_s, self._settings)
        first = store.version(number)
        assert first is not None  # Kept together with the round's stage.
        if not finding.over:
            self._wait_for(finding.reason)
        elif finding.reason:
            self._take_back(finding.reason)
        else:
            self._admit(first.model_copy(update={"robots": (), "epoch": self._epoch}))

    def _same_weights(self) -> list[int]:
        """All numbers of the version in force: one that was put back has episodes under another."""
        alike = (
            one
            for one in self._parts.store.versions()
            if (one.tensors, one.bank) == (self._in_force.tensors, self._in_force.bank)
        )
        return [one.number for one in alike]

    def _wait_for(self, reason: str) -> None:
        """Have on record what a running round waits for."""
        if reason != self.round.reason:
            self.round = self.round.model_copy(update={"reason": reason})
            self._parts.store.advance(self.round)

    def _go_on_watching(self, number: int) -> None:
        first = self._parts.store.version(number)
        assert first is not None  # Kept together with the round's stage.
        self._publish(first)
        self._step = self._watch

    def _admit(self, made: PolicyRecord) -> None:
        self._end(RoundState.PASSED, "", made)
        self.made = made
        self._publish(made)

    def _take_back(self, reason: str) -> None:
        """The robots that went first go back, by a version of the former weights."""
        back = again(self._in_force, self._parts, self._epoch)
        self._end(RoundState.REFUSED, reason, back)
        self.made = back
        self._publish(back)

    def _publish(self, record: PolicyRecord) -> None:
        came_of = descent(record, self._parts.store)
        self._parts.publisher.publish(record, self._epoch, came_of)

    # -- its end

    def _fail(self, error: PolicyError) -> None:
        self._end(RoundState.FAILED, str(error))
        if isinstance(error, FrozenError):
            self.stopped = str(error)

    def _end(self, state: RoundState, reason: str, version: PolicyRecord | None = None) -> None:
        ended = self.round.model_copy(
            update={"state": state, "reason": reason, "ended_ns": self._parts.clock.now_ns()}
        )
        self._parts.store.end(ended, version)
        self._parts.trainer.forget(ended)
        self.round = ended
        self._log.info(
            "a round ended", round=ended.number, state=str(state), reason=reason, **ended.figures
        )

    def _record(self, candidate: Candidate) -> PolicyRecord:
        """The candidate as the next version."""
        store = self._parts.store
        return PolicyRecord(
            number=next_number(store),
            epoch=self._epoch,
            tensors=candidate.tensors,
            bank=candidate.bank,
            settings=candidate.settings,
            low_level_sha256=self._in_force.low_level_sha256,
            marks=store.survey(self.round.manifest).marks,
            created_ns=self._parts.clock.now_ns(),
        )


def next_number(store: Store) -> int:
    """Of the next version; numbers never go back."""
    return store.versions()[-1].number + 1


def again(record: PolicyRecord, parts: Parts, epoch: int, ruling: str = "") -> PolicyRecord:
    """The weights of an earlier version under a new number, for all robots."""
    return record.model_copy(
        update={
            "number": next_number(parts.store),
            "epoch": epoch,
            "again": record.number,
            "robots": (),
            "ruling": ruling,
            "marks": parts.store.survey(Manifest()).marks,
            "created_ns": parts.clock.now_ns(),
        }
    )
