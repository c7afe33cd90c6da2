"""Lessons: which correction was learned in which version, told to whoever asks.

What a round was trained with stands in its candidate; what came of the round, with the versions. So
the answer is the same after a restart, and a rollback doesn't change it.
"""

import threading
from collections.abc import Iterator
from typing import Any

from services.learner.descent import descents
from services.learner.store.store import Store
from shared.messages.learned import LearnedAnswer, LearnedQuestion
from shared.messages.policy import Version
from shared.wire.bus import Bus, Subscription
from shared.wire.codec import decode, encode
from shared.wire.keys import service_key


class Known(dict[str, Version]):
    """Corrections with the first version that learned each. held_out: those kept aside so far."""

    held_out: frozenset[str] = frozenset()


class Lessons:
    """Answers on a bus thread; reads the store anew only when another version is in force."""

    def __init__(self, bus: Bus, fleet: str, learner: str, store: Store) -> None:
        self._bus, self._store = bus, store
        self._key = service_key(fleet, "learner", learner, "learned")
        self._serving: Subscription | None = None
        self._lock = threading.Lock()
        self._number = -1
        self._known = Known()

    def start(self) -> None:
        """Begin to answer."""
        self._serving = self._bus.serve(self._key, self._answer, capacity=16)

    def close(self) -> None:
        """Answer nobody any more."""
        if self._serving:
            self._serving.close()

    def _answer(self, key: str, payload: bytes) -> bytes:
        del key  # Unused: it is this learner's.
        asked = decode(LearnedQuestion, payload).corrections
        known = self._newest()
        learned = {name: known[name] for name in asked if name in known}
        aside = tuple(name for name in asked if name in known.held_out and name not in known)
        return encode(LearnedAnswer(learned=learned, held_out=aside))

    def _newest(self) -> Known:
        in_force = self._store.version()
        number = in_force.number if in_force else -1
        with self._lock:
            if number != self._number:
                self._known, self._number = study(self._store), number
            return self._known


def study(store: Store) -> Known:
    """What every version that was put in force for all was trained with."""
    known, held_out = Known(), set[str]()
    for version, candidate in _made(store):
        for name in candidate.get("learned", ()):
            known.setdefault(name, version)
        held_out.update(candidate.get("held_out", ()))
    known.held_out = frozenset(held_out)
    return known


def _made(store: Store) -> Iterator[tuple[Version, dict[str, Any]]]:
    """The versions of rounds, the oldest first, each with what its training told.

    A version with the weights of an earlier one was made by none.
    """
    versions = store.versions()
    came_of = descents(versions, store.rounds(), store.answers())
    for version in versions:
        round_, again, _ = came_of[version.number]
        if round_ and round_.candidate and again is None and not version.robots:
            yield Version(version.epoch, version.number), round_.candidate
