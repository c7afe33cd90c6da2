"""The bus as everybody sees it: put, subscribe, serve, ask, latest, follow, alive.

Two things implement it, and one contract suite holds them to it (`tests/contract`): `ZenohBus`
between processes, `MemoryBus` within one.
"""

from collections.abc import Callable
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Protocol

from pydantic import Field, SecretStr

from shared.config import Settings
from shared.errors import MessageError
from shared.messages.message import Id
from shared.wire.closing import Closing
from shared.wire.codec import MAX_BYTES

Handler = Callable[[str, bytes], None]
Answer = Callable[[str, bytes], bytes]
AliveHandler = Callable[[str, bool], None]

INTERNAL_ERROR = "internal error"  # the reason of a refusal that nobody meant


class Urgency(StrEnum):
    """Which queue a message waits in: corrections first, tensors last."""

    REAL_TIME = "real-time"
    NORMAL = "normal"
    BACKGROUND = "background"


class Subscription(Protocol):
    """What was asked of the bus; it lasts until it is closed, also across lost connections."""

    def close(self) -> None:
        """End it, and the thread of its handler; closing twice is fine."""
        ...

    @property
    def dropped(self) -> int:
        """Messages that found the queue full (or were too large), so far."""
        ...


class Bus(Closing, Protocol):
    """A place where services speak by messages. All methods may be called from any thread.

    Handlers run in a thread of their subscription's own, one message at a time, from a bounded
    queue; an exception in one is logged, and the next message is handled. A bus hears itself:
    its own subscriptions get what it puts.
    """

    def put(
        self,
        key: str,
        payload: bytes,
        urgency: Urgency = Urgency.NORMAL,
        *,
        droppable: bool = False,
    ) -> None:
        """Send to whoever subscribes now. Returning means queued, not delivered.

        Without a connection it is lost in silence; what may not be lost goes by a `Courier`.
        droppable: lose it rather than wait when a queue on the way is full. Otherwise many
            megabytes to a subscriber that hangs hold `put` up for a second, once.

        Raises:
            MessageError: not a key, or more than `MAX_BYTES` of payload.
        """
        ...

    def subscribe(
        self, keys: str, handler: Handler, *, capacity: int = 256, newest: bool = True
    ) -> Subscription:
        """Call `handler(key, payload)` for every put that matches.

        newest: when the queue is full the oldest waiting is dropped (else the one that comes).
        """
        ...

    def serve(self, keys: str, handler: Answer, *, capacity: int = 1024) -> Subscription:
        """Answer whoever asks a matching key by `handler(key, payload)`, one after the other.

        An `HldError` is a refusal with its text; any other exception is one with
        `INTERNAL_ERROR`, and is logged. When the queue is full the question gets no answer.
        """
        ...

    def ask(
        self,
        key: str,
        payload: bytes = b"",
        *,
        timeout_s: float = 2.0,
        urgency: Urgency = Urgency.NORMAL,
    ) -> bytes:
        """The first answer of those who serve `key` (a pattern asks whoever matches).

        Raises:
            NoAnswerError: nobody serves it, or nobody answered in time.
            RefusedError: everybody who answered said no.
        """
        ...

    def latest(self, key: str, payload: bytes) -> None:
        """Put a value that is also kept, for those who `follow` or `ask` later."""
        ...

    def follow(self, keys: str, handler: Handler) -> Subscription:
        """Call `handler` with the latest value of each matching key, then with every newer one.

        A value that was put while the connection was lost comes once it is back (newest wins;
        those between may be missed). The same value may come again after its writer restarted.
        """
        ...

    def watched(self, key: str) -> bool:
        """Somebody subscribes to this key now, as far as this bus has heard."""
        ...

    def alive(self, key: str) -> None:
        """Tell that this process lives, until the bus is closed or the process dies."""
        ...

    def watch_alive(self, keys: str, handler: AliveHandler) -> Subscription:
        """Call `handler(key, True)` for all who are and come alive, False for who goes."""
        ...

    @property
    def connected(self) -> bool:
        """There is a router to speak through, as far as this bus has noticed."""
        ...

    def joined(self, timeout_s: float) -> bool:
        """Wait until the router was found for the first time; False when the time is out."""
        ...

    def close(self) -> None:
        """End everything that was asked of this bus; closing twice is fine."""
        ...


class BusSettings(Settings):
    """How a service finds its router.

    connect: endpoints, such as tcp/127.0.0.1:7447; beyond this machine only tls/HOST:PORT.
    ca_certificate, certificate, private_key: PEM files for TLS, in which both sides show who
        they are; all three or none.
    user, password: for a router that asks for them as well.
    lease_ms: silence after which the other side counts as gone.
    """

    fleet: Id = "lab"
    connect: Annotated[tuple[str, ...], Field(min_length=1)] = ("tcp/127.0.0.1:7447",)
    ca_certificate: Path | None = None
    certificate: Path | None = None
    private_key: Path | None = None
    user: str | None = None
    password: SecretStr | None = None
    lease_ms: Annotated[int, Field(ge=500, le=60_000)] = 2000


def check_payload(key: str, payload: bytes) -> None:
    """Refuse what is too large for the bus.

    Raises:
        MessageError: it is more than `MAX_BYTES`.
    """
    if len(payload) > MAX_BYTES:
        raise MessageError(f"{key}: {len(payload)} bytes are too many: at most {MAX_BYTES}")


def open_bus(settings: BusSettings) -> Bus:
    """A bus through the router of `settings`; returns at once, whether there is one or not.

    Raises:
        ConfigError: an endpoint that isn't safe or isn't one, or a file that isn't there.
    """
    # Here and not above: who needs only the protocol or the fake doesn't load Zenoh.
    from shared.wire.session import ZenohBus

    return ZenohBus(settings)
