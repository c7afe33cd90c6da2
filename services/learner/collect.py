"""Take in what robots did and people said; the first step of a round, and it never pauses.

Everything is on the disk before its sender hears "ok" and may forget it.
"""

from collections.abc import Callable

import structlog

from services.learner.store.store import Kept, Store
from shared.clock import Clock
from shared.errors import MessageError, RefusedError
from shared.messages.correction import Correction
from shared.messages.decision import Decision
from shared.messages.episode import Episode
from shared.messages.receipt import Receipt
from shared.messages.ruling import Ruling
from shared.seeds import COLLECTION, purpose
from shared.wire.bus import Bus, Subscription
from shared.wire.codec import decode
from shared.wire.keys import ACTOR, any_robot, any_service, parse

OK = b"ok"
CORRECTION_API = "correction-api"


class Collector:
    """Serves the messages that may not be lost; each on a thread of its own."""

    def __init__(self, bus: Bus, fleet: str, store: Store, clock: Clock) -> None:
        self._bus, self._fleet, self._store, self._clock = bus, fleet, store, clock
        self._served: list[Subscription] = []
        self._log = structlog.get_logger()

    def start(self) -> None:
        """Begin to answer."""
        from_api = (any_service(self._fleet, CORRECTION_API, name) for name in _FROM_API)
        keys = [any_robot(self._fleet, "decision"), any_robot(self._fleet, "episode"), *from_api]
        self._served = [self._bus.serve(key, self.take) for key in keys]

    def close(self) -> None:
        """Answer nobody any more."""
        for subscription in self._served:
            subscription.close()

    def take(self, key: str, payload: bytes) -> bytes:
        """Keep one message.

        Raises:
            MessageError: no such message, or one robot's under the key of another.
            RefusedError: another message has its id, or its episode may not be learned from.
        """
        address = parse(key)
        message = _DECODE[address.message](payload)
        robot = "" if isinstance(message, Ruling) else message.robot
        if address.service == ACTOR and robot != address.id:
            raise MessageError(f"{robot}'s {address.message} came as {address.id}'s")
        if isinstance(message, Episode):
            _check_seed(message)
        if self._store.add(message, self._clock.now_ns()):
            self._log.debug("kept", message=address.message, robot=robot)
        return OK


def _check_seed(episode: Episode) -> None:
    """Raises: RefusedError, so that nothing is learned from a scene that is for evaluation."""
    if episode.seed not in COLLECTION:
        raise RefusedError(
            f"episode {episode.id} has seed {episode.seed}, which is for {purpose(episode.seed)}; "
            f"seeds to learn from are {COLLECTION.start} to {COLLECTION.stop - 1}"
        )


def _reader(kind: type[Kept]) -> Callable[[bytes], Kept]:
    return lambda payload: decode(kind, payload)


_DECODE: dict[str, Callable[[bytes], Kept]] = {
    "decision": _reader(Decision),
    "episode": _reader(Episode),
    "correction": _reader(Correction),
    "receipt": _reader(Receipt),
    "ruling": _reader(Ruling),
}
_FROM_API = ("correction", "receipt", "ruling")
