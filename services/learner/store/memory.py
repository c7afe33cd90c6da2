"""A store in memory, for tests: the same contract, nothing on a disk."""

import threading
from collections.abc import Iterable, Iterator
from typing import Any

from services.learner.store.rows import id_of
from services.learner.store.store import (
    Answer,
    Arrival,
    DecisionHead,
    History,
    Kept,
    Manifest,
    Marks,
    PolicyRecord,
    Round,
    RoundState,
    Survey,
    Tally,
    Trial,
)
from shared.errors import RefusedError
from shared.messages.correction import HINDSIGHT, Correction, Kind
from shared.messages.decision import Decision
from shared.messages.episode import Episode, Outcome
from shared.messages.receipt import Receipt
from shared.messages.ruling import Ruling
from shared.wire.codec import encode


class MemoryStore:
    """A `Store` that forgets everything at the end. One lock around everything."""

    def __init__(self) -> None:
        self._lock = threading.RLock()
        self._kept: dict[type[Kept], dict[str, tuple[Any, int]]] = {
            kind: {} for kind in (Decision, Correction, Receipt, Episode, Ruling)
        }
        self._epochs: list[str] = []
        self._rounds: dict[int, Round] = {}
        self._versions: dict[int, PolicyRecord] = {}
        self._answers: dict[str, Answer] = {}
        self._trials: dict[tuple[str, str, int], Trial] = {}

    def close(self) -> None:
        """Nothing to give back."""

    # -- what arrives

    def add(self, message: Kept, now_ns: int) -> bool:
        with self._lock:
            kept, id_ = self._kept[type(message)], id_of(message)
            if id_ not in kept:
                kept[id_] = (message, now_ns)
                return True
            if encode(kept[id_][0]) != encode(message):
                raise RefusedError(f"another {type(message).__name__.lower()} has the id {id_}")
            return False

    def _marks(self) -> Marks:
        with self._lock:
            return Marks(
                decisions=len(self._kept[Decision]),
                corrections=len(self._kept[Correction]),
                receipts=len(self._kept[Receipt]),
                episodes=len(self._kept[Episode]),
                rulings=len(self._kept[Ruling]),
            )

    def tally(self, since: Marks) -> Tally:
        with self._lock:
            episodes = [*self._all(Episode)][since.episodes :]
            episodes = [one for one in episodes if one.outcome is not Outcome.ABORTED]
            return Tally(
                episodes=len(episodes),
                successes=sum(episode.success for episode in episodes),
                corrections=sum(map(self._obeyed, [*self._all(Receipt)][since.receipts :])),
                decisions=len(self._kept[Decision]) - since.decisions,
            )

    def survey(self, after: Manifest) -> Survey:
        with self._lock:
            arrivals = (
                self._arrival(episode, arrived_ns)
                for place, (episode, arrived_ns) in enumerate(self._kept[Episode].values())
                if place >= after.marks.episodes or episode.id in after.excluded
            )
            return Survey(self._marks(), tuple(arrivals), self._hindsight(after))

    def _hindsight(self, after: Manifest) -> int:
        said = [*self._all(Correction)]
        had, since = said[: after.marks.corrections], said[after.marks.corrections :]
        known = {one.id for one in self.history(after).episodes}
        retracted = {one.target for one in since if one.kind is Kind.RETRACT}
        back = sum(one.id in retracted and one.episode in known for one in had)
        return back + sum(one.kind in HINDSIGHT for one in since)

    def _arrival(self, episode: Episode, arrived_ns: int) -> Arrival:
        decisions = sum(kept.episode == episode.id for kept in self._all(Decision))
        overrides = sum(
            receipt.episode == episode.id and self._obeyed(receipt)
            for receipt in self._all(Receipt)
        )
        missing = max(0, episode.decisions - decisions), max(0, episode.corrections - overrides)
        aborted = episode.outcome is Outcome.ABORTED
        return Arrival(episode.id, aborted, arrived_ns, *missing, overrides)

    def _obeyed(self, receipt: Receipt) -> bool:
        answered, _ = self._kept[Correction].get(receipt.correction, (None, 0))
        return receipt.accepted and answered is not None and answered.kind is Kind.OVERRIDE

    def _all(self, kind: type[Kept]) -> Iterator[Any]:
        return (message for message, _ in self._kept[kind].values())

    def history(self, manifest: Manifest) -> History:
        marks = manifest.marks
        with self._lock:
            episodes = [*self._all(Episode)][: marks.episodes]
            episodes = [episode for episode in episodes if episode.id not in manifest.excluded]
            known = {episode.id for episode in episodes}

            def first(kind: type[Kept], count: int) -> list[Any]:
                kept = [*self._all(kind)][:count]
                return [message for message in kept if message.episode in known]

            return History(
                tuple(head_of(decision) for decision in first(Decision, marks.decisions)),
                tuple(first(Correction, marks.corrections)),
                tuple(first(Receipt, marks.receipts)),
                tuple(episodes),
                tuple([*self._all(Ruling)][: marks.rulings]),
            )

    def episodes_under(self, number: int) -> tuple[Episode, ...]:
        with self._lock:
            return tuple(one for one in self._all(Episode) if one.version.number == number)

    def decisions(self, ids: Iterable[str]) -> Iterator[Decision]:
        for id_ in ids:
            if id_ not in self._kept[Decision]:
                raise RefusedError(f"no decision has the id {id_}")
            yield self._kept[Decision][id_][0]

    # -- what is made of it

    def take_over(self, learner: str, now_ns: int) -> int:
        del now_ns  # Unused.
        with self._lock:
            self._epochs.append(learner)
            return len(self._epochs)

    def epoch(self) -> int:
        return len(self._epochs)

    def begin(self, round_: Round) -> None:
        with self._lock:
            self._check_epoch(round_.epoch)
            if round_.number in self._rounds:
                raise RefusedError(f"round {round_.number} was begun before")
            self._rounds[round_.number] = round_

    def advance(self, round_: Round, version: PolicyRecord | None = None) -> None:
        with self._lock:
            self._check_running(round_)
            if version is not None:
                self._keep(version)
            self._rounds[round_.number] = round_

    def end(self, round_: Round, version: PolicyRecord | None = None) -> None:
        with self._lock:
            self._check_running(round_)
            if version is not None:
                self._keep(version, trial=version.number == round_.made)
            self._rounds[round_.number] = round_

    def _check_running(self, round_: Round) -> None:
        held = self._rounds.get(round_.number)
        if held is None or held.state is not RoundState.RUNNING:
            raise RefusedError(f"round {round_.number} is not running")

    def _keep(self, version: PolicyRecord, trial: bool = False) -> None:
        self._check_epoch(version.epoch)
        held = self._versions.get(version.number)
        if held is not None and not (held.robots and trial):
            raise RefusedError(f"there is a version {version.number} already")
        self._versions[version.number] = version

    def rounds(self) -> tuple[Round, ...]:
        with self._lock:
            return tuple(self._rounds[number] for number in sorted(self._rounds))

    def found(self, version: PolicyRecord) -> None:
        with self._lock:
            self._check_epoch(version.epoch)
            if self._versions:
                raise RefusedError("the store has a version already")
            self._versions[version.number] = version

    def version(self, number: int | None = None) -> PolicyRecord | None:
        with self._lock:
            if number is not None:
                return self._versions.get(number)
            return next((one for one in reversed(self.versions()) if not one.robots), None)

    def versions(self) -> tuple[PolicyRecord, ...]:
        with self._lock:
            return tuple(self._versions[number] for number in sorted(self._versions))

    # -- what people decided, and what the gate tried

    def answers(self) -> tuple[Answer, ...]:
        with self._lock:
            return tuple(
                self._answers.get(ruling.id, Answer(ruling=ruling)) for ruling in self._all(Ruling)
            )

    def answer(self, answer: Answer, version: PolicyRecord | None = None) -> None:
        with self._lock:
            id_ = answer.ruling.id
            if id_ in self._answers or id_ not in self._kept[Ruling]:
                raise RefusedError(f"ruling {id_} is unknown or was answered before")
            if version is not None:
                self._keep(version)
            self._answers[id_] = answer

    def trials(self, policy: str, plan: str) -> dict[int, Trial]:
        with self._lock:
            kept = self._trials.values()
            return {one.seed: one for one in kept if (one.policy, one.plan) == (policy, plan)}

    def add_trial(self, trial: Trial) -> bool:
        with self._lock:
            place = (trial.policy, trial.plan, trial.seed)
            fresh = place not in self._trials
            self._trials.setdefault(place, trial)
            return fresh

    def _check_epoch(self, mine: int) -> None:
        if len(self._epochs) != mine:
            raise RefusedError(f"the store is in epoch {len(self._epochs)}, which is not {mine}")


def head_of(decision: Decision) -> DecisionHead:
    """What the labels are derived from."""
    return DecisionHead(
        decision.id,
        decision.robot,
        decision.episode,
        decision.step,
        decision.executed.text,
        decision.proposed[0].goal.text,
        decision.chosen_by,
        decision.time_ns,
    )
