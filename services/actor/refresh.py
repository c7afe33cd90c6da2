"""Refresh: take up what the learner announces, verified, whole, and never an older version."""

import hashlib
import shutil
import threading
from collections.abc import Iterable, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import structlog

from shared.errors import HldError
from shared.messages.policy import PolicyAnnouncement, TensorRef
from shared.policies.checkpoint import Card, save
from shared.policies.high_level import HighLevel
from shared.wire.bus import Bus
from shared.wire.codec import decode
from shared.wire.keys import any_service
from shared.wire.tensors import TensorFetcher

FETCH_WITHIN_S = 60.0
log = structlog.get_logger()


class Refresh:
    """Follows the learner's announcements on a bus thread; runners ask for the newest version.

    newest: the newest high level for all robots that was fetched and verified. Runners share it:
        it is never changed, only replaced.
    refused: announcements that could not be used, each with its reason in the log.
    """

    def __init__(
        self,
        bus: Bus,
        fleet: str,
        start: HighLevel,
        low_level_sha256: str,
        folder: Path,
        robots: Iterable[str] = (),
    ) -> None:
        """start: what runs until something is announced. robots: of this actor."""
        self._robots = frozenset(robots)
        self._folder = folder
        self._low_level_sha256 = low_level_sha256
        anywhere = any_service(fleet, "learner", "tensor")
        self._fetcher = TensorFetcher(bus, anywhere, by_hash(start.tensors()))
        self._arrived = threading.Event()
        self.newest = start
        self.refused = 0
        self._first: tuple[HighLevel, tuple[str, ...]] | None = None
        self._subscriptions = [
            bus.follow(any_service(fleet, "learner", "policy"), self._announced),
            bus.follow(any_service(fleet, "learner", "canary"), self._announced_for_some),
        ]

    def wait(self, timeout_s: float) -> bool:
        """Until the first announcement was taken up; False when none came in time."""
        return self._arrived.wait(timeout_s)

    def close(self) -> None:
        """Follow no longer."""
        for subscription in self._subscriptions:
            subscription.close()
        self._fetcher.close()

    def of(self, robot: str) -> "RobotsVersion":
        """What one robot is to run."""
        return RobotsVersion(self, robot)

    def newest_for(self, robot: str) -> HighLevel:
        """The newest high level for a robot: one that some robots run first, if it is of them."""
        first = self._first
        if first and robot in first[1] and first[0].version > self.newest.version:
            return first[0]
        return self.newest

    def _announced(self, key: str, payload: bytes) -> None:
        try:
            announcement = decode(PolicyAnnouncement, payload)
            if announcement.version > self.newest.version:
                high_level = self._fetched(announcement)
                keep(high_level, self._folder)
                self.newest = high_level
                log.info("policy ready", version=str(announcement.version))
            elif announcement.version < self.newest.version:
                log.warning(
                    "an older version was announced, and is not taken up",
                    announced=str(announcement.version),
                    running=str(self.newest.version),
                )
            self._arrived.set()
        except HldError as error:
            self.refused += 1
            log.error("announced policy refused", key=key, reason=str(error))

    def _announced_for_some(self, key: str, payload: bytes) -> None:
        try:
            announcement = decode(PolicyAnnouncement, payload)
            known = self._first[0].version if self._first else self.newest.version
            if announcement.version > known and set(announcement.robots) & self._robots:
                self._first = self._fetched(announcement), announcement.robots
                log.info("policy ready for a trial", version=str(announcement.version))
        except HldError as error:
            self.refused += 1
            log.error("announced policy refused", key=key, reason=str(error))

    def _fetched(self, announcement: PolicyAnnouncement) -> HighLevel:
        if announcement.low_level_sha256 != self._low_level_sha256:
            raise HldError(
                f"version {announcement.version} was made for low level "
                f"{announcement.low_level_sha256[:12]}, this robot runs "
                f"{self._low_level_sha256[:12]}"
            )
        payloads = self._fetcher.fetch(announcement.tensors, FETCH_WITHIN_S)
        tensors = {ref.name: as_array(ref, payloads[ref.sha256]) for ref in announcement.tensors}
        return HighLevel.build(announcement, tensors, self.newest.head)


class RobotsVersion:
    """The view that one robot has of its actor's `Refresh`."""

    def __init__(self, refresh: Refresh, robot: str) -> None:
        self._refresh, self._robot = refresh, robot

    @property
    def newest(self) -> HighLevel:
        """See `PolicySource`."""
        return self._refresh.newest_for(self._robot)


def keep(high_level: HighLevel, folder: Path) -> None:
    """Put a version on the disk, so that a restarted robot goes on with it; whole or not at all."""
    card = Card(
        name="high_level",
        title=f"High level, version {high_level.version}",
        version=str(high_level.version),
        date=datetime.now(UTC).date().isoformat(),
        recipe=("Taken up from the learner's announcement.",),
        command="hld actor",
        seed=0,
        data_sha256="",
        tensors_sha256="",
        settings={**high_level.settings(), "bank": "\n".join(high_level.bank.phrases)},
    )
    part = folder.with_name(folder.name + ".part")
    shutil.rmtree(part, ignore_errors=True)
    save(part, high_level.tensors(), card)
    shutil.rmtree(folder, ignore_errors=True)
    part.rename(folder)


def by_hash(tensors: Mapping[str, np.ndarray[Any, Any]]) -> dict[str, bytes]:
    """The bytes of tensors under their hash, as they travel."""
    payloads = [np.ascontiguousarray(array).tobytes() for array in tensors.values()]
    return {hashlib.sha256(payload).hexdigest(): payload for payload in payloads}


def as_array(ref: TensorRef, payload: bytes) -> np.ndarray[Any, Any]:
    """The tensor that `ref` describes, from its verified bytes."""
    return np.frombuffer(payload, dtype=ref.dtype).reshape(ref.shape).copy()
