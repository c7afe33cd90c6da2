"""The learner from its start to its end: collect all the time, and turn round after round.

collect · aggregate · train · gate · publish, each a file of this folder; `turn.py` has their order.
"""

from collections.abc import Callable

import structlog

from services.learner.config import LearnerSettings
from services.learner.descent import descent
from services.learner.publish import LEARNER
from services.learner.rounds import due, last_manifest, next_manifest, take_stock
from services.learner.rulings import carry_out
from services.learner.store.store import Manifest, PolicyRecord, Round, RoundState
from services.learner.trials import policy_sha256
from services.learner.turn import Parts, Turn
from shared.errors import FrozenError, RefusedError
from shared.messages.heartbeat import LearnerHeartbeat, LearnerState
from shared.messages.policy import Version
from shared.service import Stop
from shared.wire.codec import encode
from shared.wire.keys import service_key

BEAT_NS = 500_000_000
LOOK_S = 0.1
ATTEMPTS = 5  # learners that may die of one round before it counts as failed

Origin = Callable[[], PolicyRecord]


class Learner:
    """Owns the store's epoch and the only thread that begins and ends rounds."""

    def __init__(self, parts: Parts, settings: LearnerSettings, origin: Origin) -> None:
        """origin: makes what a fresh store starts from; the epoch is filled in."""
        self._parts, self._settings = parts, settings
        self._log = structlog.get_logger()
        self._epoch = parts.store.take_over(settings.id, parts.clock.now_ns())
        self._in_force = self._found(origin)
        self._turn: Turn | None = None
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
        self._publish()
        parts.collector.start()
        parts.gate.start()
        parts.lessons.start()
        parts.bus.alive(self._alive_key)
        try:
            parts.frozen.check_against(self._in_force.low_level_sha256)
            self._resume()
        except FrozenError as error:
            self._stop(str(error))
        self._beat()

    def tick(self) -> None:
        """One look at everything; never waits for long."""
        if self._turn is not None:
            self._turn.follow()
            self._look_at(self._turn)
        if self._parts.clock.monotonic_ns() - self._beat_ns >= BEAT_NS:
            self._check_epoch()
            self._mind_rulings()
            if self._turn is None and not self._stopped:
                self._consider()
            self._beat()

    def close(self) -> None:
        """Leave a round that is at work to the next learner of this store."""
        self._parts.trainer.stop()
        self._parts.gate.close()
        self._parts.lessons.close()
        self._parts.collector.close()
        self._parts.publisher.close()

    # -- a round

    def _consider(self) -> None:
        """Begin a round if one is due."""
        parts, settings = self._parts, self._settings.round
        marks, arrivals, hindsight = parts.store.survey(self._used)
        stock = take_stock(arrivals, parts.clock.now_ns(), settings.patience_s, hindsight)
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
            manifest=next_manifest(
                marks,
                stock,
                self._settings.recipe().model_dump(mode="json"),
                **self._sources(),
            ),
            begun_ns=parts.clock.now_ns(),
        )
        parts.store.begin(round_)
        self._rounds = (*self._rounds, round_)
        self._begin(round_)

    def _sources(self) -> dict[str, str]:
        """Hashes of what a round starts from, for its manifest."""
        base = self._parts.store.version(0)
        assert base is not None  # The store was founded with it.
        return {
            "demonstrations": self._parts.trainer.demonstrations(),
            "base": policy_sha256(base),
            "parent": policy_sha256(self._in_force),
        }

    def _resume(self) -> None:
        """Begin a round again that was at work when its learner died."""
        if not self._rounds or self._rounds[-1].state is not RoundState.RUNNING:
            return
        round_ = self._rounds[-1]
        reason = ""
        if self._epoch - round_.epoch > ATTEMPTS:
            reason = f"{ATTEMPTS} learners ended while it ran"
        elif round_.parent != self._in_force.number:  # Its learner died before it could say so.
            reason = f"version {self._in_force.number} was put in force while it ran"
        if reason:
            turn = self._made_turn(round_)
            turn.abandon(reason)
            self._look_at(turn)
        else:
            self._begin(round_)

    def _begin(self, round_: Round) -> None:
        self._used = round_.manifest
        self._turn = self._made_turn(round_)
        self._turn.begin()
        self._look_at(self._turn)

    def _made_turn(self, round_: Round) -> Turn:
        canary = self._settings.gate.canary
        return Turn(self._parts, canary, self._epoch, self._in_force, round_)

    def _look_at(self, turn: Turn) -> None:
        """See whether a round is over, and what is in force now."""
        self._in_force = turn.made or self._in_force
        if turn.over:
            self._rounds = (*self._rounds[:-1], turn.round)
            self._turn, self._ended_ns = None, self._parts.clock.monotonic_ns()
        if turn.stopped:
            self._stop(turn.stopped)

    def _mind_rulings(self) -> None:
        """Do what people decided since the last look."""
        for answer in self._parts.store.answers():
            if answer.answered_ns is not None:
                continue
            done, made = carry_out(answer.ruling, self._parts, self._epoch, self._in_force)
            self._log.info("ruled", verb=str(done.ruling.verb), made=done.made, reason=done.reason)
            if made:
                if self._turn:
                    self._turn.abandon(f"version {made.number} was put in force while it ran")
                    self._look_at(self._turn)
                self._in_force = made
                self._publish()

    def _publish(self) -> None:
        """Announce what is in force."""
        came_of = descent(self._in_force, self._parts.store)
        self._parts.publisher.publish(self._in_force, self._epoch, came_of)

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
            progress=self._turn.progress() if self._turn else 0.0,
            **tally._asdict(),
        )

    def _state(self) -> LearnerState:
        if self._stopped:
            return LearnerState.STOPPED
        return self._turn.state if self._turn else LearnerState.COLLECTING
