"""The learner from its start to its end: collect all the time, and turn round after round.

collect · aggregate · train · gate · publish, each a file of this folder; here is their order.
"""

import dataclasses
from collections.abc import Callable
from typing import Protocol

import structlog

from services.learner.collect import Collector
from services.learner.config import LearnerSettings
from services.learner.frozen import FrozenLowLevel
from services.learner.gate import Candidate, Gate
from services.learner.publish import LEARNER, Publisher
from services.learner.rounds import due, last_manifest, next_manifest, take_stock
from services.learner.store.store import Manifest, PolicyRecord, Round, RoundState, Store
from shared.clock import Clock
from shared.errors import FrozenError, PolicyError, RefusedError
from shared.messages.heartbeat import LearnerHeartbeat, LearnerState
from shared.messages.policy import Version
from shared.service import Stop
from shared.wire.bus import Bus
from shared.wire.codec import encode
from shared.wire.keys import service_key

BEAT_NS = 500_000_000
LOOK_S = 0.1
ATTEMPTS = 5  # learners that may die of one round before it counts as failed


Origin = Callable[[], PolicyRecord]


class Trainer(Protocol):
    """Trains one round at a time, beside the learner's own thread."""

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
    clock: Clock


class Learner:
    """Owns the store's epoch and the only thread that begins and ends rounds."""

    def __init__(self, parts: Parts, settings: LearnerSettings, origin: Origin) -> None:
        """origin: makes what a fresh store starts from; the epoch is filled in."""
        self._parts, self._settings = parts, settings
        self._log = structlog.get_logger()
        self._epoch = parts.store.take_over(settings.id, parts.clock.now_ns())
        self._in_force = self._found(origin)
        self._round: Round | None = None
        self._rounds = parts.store.rounds()
        self._used: Manifest = last_manifest(self._rounds)
        self._ended_ns = parts.clock.monotonic_ns()
        self._beat_ns = self._ended_ns
        self._stopped = ""
        fleet = settings.bus.fleet
        self._heartbeat_key = service_key(fleet, LEARNER, settings.id, "heartbeat")
        self._alive_key = service_key(fleet, LEARNER, settings.id, "alive")

    @property
    def version(self) -> Version:
        """The version in force, as robots hear of it."""
        return Version(self._epoch, self._in_force.number)

    def run(self, stop: Stop) -> None:
        """Work until `stop`.

        Raises:
            RefusedError: another learner took the store over.
        """
        try:
            self.start()
            while not stop:
                self.tick()
                stop.wait(LOOK_S)
        finally:
            self.close()

    def start(self) -> None:
        """Announce what is in force, begin to collect, and go on with a round that was cut off."""
        parts = self._parts
        made_by = (one for one in self._rounds if one.made == self._in_force.number)
        parts.publisher.publish(self._in_force, self._epoch, next(made_by, None))
        parts.collector.start()
        parts.bus.alive(self._alive_key)
        try:
            parts.frozen.check_against(self._in_force.low_level_sha256)
            self._resume()
        except FrozenError as error:
            self._stop(str(error))
        self._beat()

    def tick(self) -> None:
        """One look at everything; never waits for long."""
        if self._round is not None:
            self._follow(self._round)
        if self._parts.clock.monotonic_ns() - self._beat_ns >= BEAT_NS:
            self._check_epoch()
            if self._round is None and not self._stopped:
                self._consider()
            self._beat()

    def close(self) -> None:
        """Leave a round that is at work to the next learner of this store."""
        self._parts.trainer.stop()
        self._parts.collector.close()
        self._parts.publisher.close()

    # -- a round

    def _consider(self) -> None:
        """Begin a round if one is due."""
        parts, settings = self._parts, self._settings.round
        marks, arrivals = parts.store.survey(self._used)
        stock = take_stock(arrivals, parts.clock.now_ns(), settings.patience_s)
        waited_s = (parts.clock.monotonic_ns() - self._ended_ns) / 1e9
        if not due(stock, waited_s, len(self._rounds), settings):
            return
        for arrival in stock.short:
            self._log.warning("an episode is not complete, and used as it is", **arrival._asdict())
        number = len(self._rounds) + 1
        round_ = Round(
            number=number,
            epoch=self._epoch,
            parent=self._in_force.number,
            seed=self._settings.seed + number,
            manifest=next_manifest(marks, stock, self._settings.recipe().model_dump(mode="json")),
            begun_ns=parts.clock.now_ns(),
        )
        parts.store.begin(round_)
        self._rounds = (*self._rounds, round_)
        self._begin(round_)

    def _resume(self) -> None:
        """Begin a round again that was at work when its learner died."""
        if not self._rounds or self._rounds[-1].state is not RoundState.RUNNING:
            return
        round_ = self._rounds[-1]
        if self._epoch - round_.epoch > ATTEMPTS:
            self._end(round_, RoundState.FAILED, f"{ATTEMPTS} learners ended while it ran")
        else:
            self._begin(round_)

    def _begin(self, round_: Round) -> None:
        self._log.info("a round begins", round=round_.number, parent=round_.parent)
        self._round, self._used = round_, round_.manifest
        try:
            self._parts.frozen.check()
            self._parts.trainer.start(round_)
        except FrozenError as error:
            self._end(round_, RoundState.FAILED, str(error))
            self._stop(str(error))

    def _follow(self, round_: Round) -> None:
        """See whether the training is over, and what comes of it."""
        try:
            candidate = self._parts.trainer.result()
            if candidate is None:
                return
            self._parts.frozen.check()
        except PolicyError as error:
            self._end(round_, RoundState.FAILED, str(error))
            if isinstance(error, FrozenError):
                self._stop(str(error))
        else:
            self._conclude(round_, candidate)

    def _conclude(self, round_: Round, candidate: Candidate) -> None:
        round_ = round_.model_copy(update={"figures": candidate.figures.model_dump(mode="json")})
        verdict = self._parts.gate.judge(candidate)
        if not verdict.passed:
            self._end(round_, RoundState.REFUSED, verdict.reason)
            return
        made = PolicyRecord(
            number=self._in_force.number + 1,
            epoch=self._epoch,
            tensors=candidate.tensors,
            bank=candidate.bank,
            settings=candidate.settings,
            low_level_sha256=self._in_force.low_level_sha256,
            marks=self._parts.store.survey(round_.manifest).marks,
            created_ns=self._parts.clock.now_ns(),
        )
        self._end(round_, RoundState.PASSED, "", made)
        self._in_force = made
        self._parts.publisher.publish(made, self._epoch, self._rounds[-1])

    def _end(
        self, round_: Round, state: RoundState, reason: str, made: PolicyRecord | None = None
    ) -> None:
        ended = round_.model_copy(
            update={
                "state": state,
                "reason": reason,
                "ended_ns": self._parts.clock.now_ns(),
                "made": made.number if made else None,
            }
        )
        self._parts.store.end(ended, made)
        self._rounds = (*self._rounds[:-1], ended)
        self._round, self._ended_ns = None, self._parts.clock.monotonic_ns()
        self._log.info(
            "a round ended", round=ended.number, state=str(state), reason=reason, **ended.figures
        )

    def _stop(self, reason: str) -> None:
        """Turn no more rounds; what arrives is still kept."""
        self._stopped = reason
        self._log.error("the learner stopped", reason=reason)

    # -- who it is and how it goes

    def _found(self, origin: Origin) -> PolicyRecord:
        held = self._parts.store.version()
        if held is None:
            held = origin().model_copy(update={"epoch": self._epoch})
            self._parts.store.found(held)
        return held

    def _check_epoch(self) -> None:
        epoch = self._parts.store.epoch()
        if epoch != self._epoch:
            raise RefusedError(f"another learner took the store over, in epoch {epoch}")

    def _beat(self) -> None:
        self._beat_ns = self._parts.clock.monotonic_ns()
        self._parts.bus.put(self._heartbeat_key, encode(self.heartbeat()))

    def heartbeat(self) -> LearnerHeartbeat:
        """What the learner has and does now."""
        tally = self._parts.store.tally(self._in_force.marks)
        return LearnerHeartbeat(
            learner=self._settings.id,
            time_ns=self._parts.clock.now_ns(),
            state=self._state(),
            version=self.version,
            round=len(self._rounds),
            reason=self._stopped,
            progress=self._parts.trainer.progress() if self._round else 0.0,
            **tally._asdict(),
        )

    def _state(self) -> LearnerState:
        if self._stopped:
            return LearnerState.STOPPED
        return LearnerState.TRAINING if self._round else LearnerState.COLLECTING
