"""Values that last: what `latest` keeps for those who come late, what `follow` has seen of it.

Every value carries a stamp: 8 random bytes that name the writing process, then a counter. A
follower takes a value of the same writer only if its counter is higher, and any value of another
writer: clocks don't matter, and a writer that restarts is followed at once. It asks again every
second with the stamps that it has, and is answered only when there is something newer, so a value
that a dying router swallowed comes all the same.
"""

import os
from collections.abc import Callable

import zenoh
from zenoh.handlers import Callback

from shared.wire.bus import Handler
from shared.wire.questions import is_message, payload_of

STAMP_BYTES = 16
_NONCE_BYTES = 8


def newer(stamp: bytes, held: bytes | None) -> bool:
    """Whether a value with `stamp` supersedes the one with `held`."""
    if held is None or stamp[:_NONCE_BYTES] != held[:_NONCE_BYTES]:
        return True
    return stamp > held


def split_stamps(data: bytes) -> set[bytes]:
    """The stamps that a follower sent along with its question."""
    return {data[i : i + STAMP_BYTES] for i in range(0, len(data), STAMP_BYTES)}


class Kept:
    """The latest value of one key, answered to whoever asks for it."""

    def __init__(self, key: str) -> None:
        self._key = key
        self._nonce = os.urandom(_NONCE_BYTES)
        self._count = 0
        self._value = (b"", b"")

    @property
    def stamp(self) -> bytes:
        """The stamp of the value that is kept now."""
        return self._value[0]

    def keep(self, payload: bytes) -> None:
        self._count += 1
        self._value = (self._nonce + self._count.to_bytes(8, "big"), payload)

    def answer(self, query: zenoh.Query) -> None:
        stamp, payload = self._value
        with query:
            if stamp not in split_stamps(payload_of(query)):
                query.reply(self._key, payload, attachment=stamp)


class Followed:
    """What one follower has seen, by key; its methods run in its worker's thread."""

    REFRESH_S = 1.0

    def __init__(self, keys: str, handler: Handler) -> None:
        self._keys = keys
        self._handler = handler
        self._seen: dict[str, bytes] = {}

    def refresh(self, session: zenoh.Session, offer: Callable[[zenoh.Sample], bool]) -> None:
        def take(reply: zenoh.Reply) -> None:
            if reply.ok is not None:
                offer(reply.ok)

        session.get(
            self._keys,
            Callback(take, indirect=False),
            target=zenoh.QueryTarget.ALL,
            consolidation=zenoh.ConsolidationMode.NONE,
            timeout=2.0,
            payload=b"".join(self._seen.values()),
        )

    def handle(self, sample: zenoh.Sample) -> None:
        key = str(sample.key_expr)
        stamp = _stamp_of(sample)
        if not is_message(sample) or (stamp and not newer(stamp, self._seen.get(key))):
            return
        if stamp:
            self._seen[key] = stamp
        self._handler(key, sample.payload.to_bytes())


def _stamp_of(sample: zenoh.Sample) -> bytes:
    """The stamp of a kept value; empty for a put that nobody keeps."""
    attachment = sample.attachment
    if attachment is None or len(attachment) != STAMP_BYTES:
        return b""
    return attachment.to_bytes()
