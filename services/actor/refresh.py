"""Refresh: take up what the learner announces, verified, whole, and never an older version."""

import hashlib
import threading
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import structlog
from shared.policies.high_level import HighLevel

from shared.errors import HldError
from shared.messages.policy import PolicyAnnouncement, TensorRef
from shared.wire.bus import Bus
from shared.wire.codec import decode
from shared.wire.keys import any_service
from shared.wire.tensors import TensorFetcher

FETCH_WITHIN_S = 60.0
log = structlog.get_logger()


class Refresh:
    """Follows the learner's announcements on a bus thread; runners ask for the newest version.

    newest: the newest high level that was fetched and verified. Runners share it: it is never
        changed, only replaced.
    refused: announcements that could not be used, each with its reason in the log.
    """

    def __init__(
        self, bus: Bus, fleet: str, start: HighLevel, low_level_sha256: str, folder: Path
    ) -> None:
        self._folder = folder
        self._low_level_sha256 = low_level_sha256
        anywhere = any_service(fleet, "learner", "tensor")
        self._fetcher = TensorFetcher(bus, anywhere, by_hash(start.tensors()))
        self._arrived = threading.Event()
        self.newest = start
        self.refused = 0
        self._subscription = bus.follow(any_service(fleet, "learner", "policy"), self._announced)

    def wait(self, timeout_s: float) -> bool:
        """Until the first announcement was taken up; False when none came in time."""
        return self._arrived.wait(timeout_s)

    def close(self) -> None:
        """Follow no longer."""
        self._subscription.close()
        self._fetcher.close()

    def _announced(self, key: str, payload: bytes) -> None:
        try:
            announcement = decode(PolicyAnnouncement, payload)
            if announcement.version > self.newest.version:
                self._take_up(announcement)
        except HldError as error:
            self.refused += 1
            log.error("announced policy refused", key=key, reason=str(error))

    def _take_up(self, announcement: PolicyAnnouncement) -> None:
        if announcement.low_level_sha256 != self._low_level_sha256:
            raise HldError(
                f"version {announcement.version} was made for low level "
                f"{announcement.low_level_sha256[:12]}, this robot runs "
                f"{self._low_level_sha256[:12]}"
            )
        payloads = self._fetcher.fetch(announcement.tensors, FETCH_WITHIN_S)
        tensors = {ref.name: as_array(ref, payloads[ref.sha256]) for ref in announcement.tensors}
        high_level = HighLevel.build(announcement, tensors)
        high_level.save(self._folder)
        self.newest = high_level
        self._arrived.set()
        log.info("policy ready", version=str(announcement.version))


def by_hash(tensors: Mapping[str, np.ndarray[Any, Any]]) -> dict[str, bytes]:
    """The bytes of tensors under their hash, as they travel."""
    payloads = [np.ascontiguousarray(array).tobytes() for array in tensors.values()]
    return {hashlib.sha256(payload).hexdigest(): payload for payload in payloads}


def as_array(ref: TensorRef, payload: bytes) -> np.ndarray[Any, Any]:
    """The tensor that `ref` describes, from its verified bytes."""
    return np.frombuffer(payload, dtype=ref.dtype).reshape(ref.shape).copy()
