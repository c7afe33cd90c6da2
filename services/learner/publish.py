"""Send a version to the robots: its tensors, then the announcement; the last step of a round."""

import structlog

from services.learner.descent import Descent
from services.learner.shelf import Shelf
from services.learner.store.store import PolicyRecord
from services.learner.store.tensors import TensorFiles
from shared.messages.policy import PolicyAnnouncement, Version
from shared.wire.bus import Bus
from shared.wire.codec import encode
from shared.wire.keys import service_key
from shared.wire.tensors import TensorPublisher

LEARNER = "learner"


class Publisher:
    """What robots hear of the learner: the newest version, for whoever comes at any time."""

    def __init__(
        self, bus: Bus, fleet: str, learner: str, files: TensorFiles, shelf: Shelf
    ) -> None:
        self._bus, self._learner, self._files, self._shelf = bus, learner, files, shelf
        self._key = service_key(fleet, LEARNER, learner, "policy")
        self._canary_key = service_key(fleet, LEARNER, learner, "canary")
        self._tensors = TensorPublisher(bus, service_key(fleet, LEARNER, learner, "tensor"))
        self._log = structlog.get_logger()

    def publish(self, record: PolicyRecord, epoch: int, came_of: Descent = Descent()) -> Version:
        """Announce `record` as (epoch, its number).

        What some robots run first has a place of its own: who comes late hears of both.

        Raises:
            PolicyError: a tensor is missing or changed on the disk.
        """
        message = announcement(record, epoch, self._learner)
        names = tuple(dict.fromkeys(ref.sha256 for ref in record.tensors))
        self._shelf.put(record, came_of)
        # Tensors first: who hears of a version can have it.
        self._tensors.publish(self._files.take(names))
        key = self._canary_key if record.robots else self._key
        self._bus.latest(key, encode(message))
        self._log.info("published", version=str(message.version), phrases=len(message.bank))
        return message.version

    def offer(self, epoch: int, *records: PolicyRecord) -> list[PolicyAnnouncement]:
        """What would be announced, with its tensors at hand for those who try it.

        Raises:
            PolicyError: a tensor is missing or changed on the disk.
        """
        names = dict.fromkeys(ref.sha256 for record in records for ref in record.tensors)
        self._tensors.publish(self._files.take(tuple(names)))
        return [announcement(record, epoch, self._learner) for record in records]

    def close(self) -> None:
        """Serve tensors to nobody any more."""
        self._tensors.close()


def announcement(record: PolicyRecord, epoch: int, learner: str) -> PolicyAnnouncement:
    """The message that stands for a kept version."""
    return PolicyAnnouncement(
        version=Version(epoch, record.number),
        learner=learner,
        created_ns=record.created_ns,
        tensors=record.tensors,
        bank=record.bank,
        low_level_sha256=record.low_level_sha256,
        settings=record.settings,
        robots=record.robots,
    )
