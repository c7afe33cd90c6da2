"""Tensors of a policy version, learner → actors: by hash, in chunks, repaired by question.

They are pushed once as they are published. Who missed a chunk, or came late, asks for it; who has
a tensor already, asks for nothing. A tensor is given out only when its hash is right.
"""

import hashlib
import threading
import time
from collections import OrderedDict
from collections.abc import Iterable, Mapping

from shared.errors import MessageError, NoAnswerError, RefusedError
from shared.messages.policy import TensorRef
from shared.wire.bus import Bus, Urgency
from shared.wire.closing import Closing
from shared.wire.keys import ANY, chunk_key, parse_chunk

CHUNK_BYTES = 1 << 20
MAX_TOTAL_BYTES = 1 << 30  # of one version; more is refused before anything is fetched
MAX_EARLY_BYTES = 64 << 20  # of chunks that came before anybody asked for their tensor

_ASK_S = 1.0
_PAUSE_S = 0.1


def chunk_count(size_bytes: int) -> int:
    """How many chunks a tensor of that size is cut into."""
    return -(-size_bytes // CHUNK_BYTES)


def chunk_size(size_bytes: int, index: int) -> int:
    """The bytes of the chunk `index` of a tensor of that size."""
    return max(0, min(CHUNK_BYTES, size_bytes - index * CHUNK_BYTES))


class TensorPublisher(Closing):
    """The learner's side: pushes tensors, and answers for those of the last two publications
    (so that a slow robot can still finish the one before)."""

    def __init__(self, bus: Bus, prefix: str) -> None:
        self._bus = bus
        self._prefix = prefix
        self._current: Mapping[str, bytes] = {}
        self._before: Mapping[str, bytes] = {}
        self._subscription = bus.serve(chunk_key(prefix, ANY, ANY), self._answer)

    def publish(self, tensors: Mapping[str, bytes]) -> int:
        """Push the tensors, by hash, that weren't in the publication before; the bytes pushed.

        A full queue loses chunks rather than wait: a robot that hangs would hold up all others,
        and who missed a chunk asks for it.
        """
        self._before, self._current = self._current, dict(tensors)
        fresh = [name for name in self._current if name not in self._before]
        for name in fresh:
            self._push(name, self._current[name])
        return sum(len(self._current[name]) for name in fresh)

    def close(self) -> None:
        """Stop answering."""
        self._subscription.close()

    def _push(self, name: str, data: bytes) -> None:
        for index in range(chunk_count(len(data))):
            key = chunk_key(self._prefix, name, index)
            self._bus.put(key, _cut(data, index), Urgency.BACKGROUND, droppable=True)

    def _answer(self, key: str, payload: bytes) -> bytes:
        del payload  # Unused: the key says it all.
        name, index = parse_chunk(key)
        data = self._current.get(name, self._before.get(name))
        if data is None or index >= chunk_count(len(data)):
            raise RefusedError(f"no chunk {index} of a tensor {name} here")
        return _cut(data, index)


class TensorFetcher(Closing):
    """The actor's side: gathers what is pushed, and asks for the rest.

    prefix: as the publisher's; `any_service(fleet, "learner", "tensor")` hears any learner.
    held: tensors by hash that need not be fetched; they stay, others go with the next version.
    """

    def __init__(self, bus: Bus, prefix: str, held: Mapping[str, bytes]) -> None:
        self._bus = bus
        self._prefix = prefix
        self._base = dict(held)
        self._held = dict(held)
        self._early = _Chunks(MAX_EARLY_BYTES)
        self._subscription = bus.subscribe(
            chunk_key(prefix, ANY, ANY), self._early.take, capacity=64
        )

    def fetch(self, refs: Iterable[TensorRef], timeout_s: float) -> dict[str, bytes]:
        """All tensors of `refs` by their hash; blocks. What came stays for another try.

        Raises:
            MessageError: they are more than `MAX_TOTAL_BYTES`.
            NoAnswerError: some didn't come in time, or never with the right hash.
        """
        wanted = _sizes(refs)
        deadline = time.monotonic() + timeout_s
        for name, size in wanted.items():
            if name not in self._held:
                self._held[name] = self._gather(name, size, deadline)
        self._held = {
            name: data for name, data in self._held.items() if name in wanted or name in self._base
        }
        self._early.clear()
        return {name: self._held[name] for name in wanted}

    def close(self) -> None:
        """Stop gathering."""
        self._subscription.close()

    def _gather(self, name: str, size: int, deadline: float) -> bytes:
        while True:
            parts = [self._part(name, size, i, deadline) for i in range(chunk_count(size))]
            data = b"".join(parts)
            if hashlib.sha256(data).hexdigest() == name:
                return data
            self._early.discard(name)  # Somebody sent rubbish under this name: ask for all anew.
            _wait(name, deadline)

    def _part(self, name: str, size: int, index: int, deadline: float) -> bytes:
        want = chunk_size(size, index)
        while True:
            part = self._early.get(name, index)
            if part is None or len(part) != want:
                part = self._ask(name, index, deadline)
            if part is not None and len(part) == want:
                self._early.take(chunk_key(self._prefix, name, index), part)
                return part
            _wait(name, deadline)

    def _ask(self, name: str, index: int, deadline: float) -> bytes | None:
        timeout_s = min(_ASK_S, max(0.01, deadline - time.monotonic()))
        key = chunk_key(self._prefix, name, index)
        try:
            return self._bus.ask(key, timeout_s=timeout_s, urgency=Urgency.BACKGROUND)
        except (NoAnswerError, RefusedError):
            return None


class _Chunks:
    """Chunks by tensor, within a limit: the tensor that came first goes first, and of one that
    alone is too large, the chunks that come last."""

    def __init__(self, max_bytes: int) -> None:
        self._max_bytes = max_bytes
        self._lock = threading.Lock()
        self._parts: OrderedDict[str, dict[int, bytes]] = OrderedDict()
        self._bytes = 0

    @property
    def size_bytes(self) -> int:
        """What is kept now."""
        return self._bytes

    def take(self, key: str, payload: bytes) -> None:
        """Keep a chunk; what is no chunk is not kept."""
        try:
            name, index = parse_chunk(key)
        except MessageError:
            return
        if len(payload) > CHUNK_BYTES:
            return
        with self._lock:
            parts = self._parts.setdefault(name, {})
            self._bytes += len(payload) - len(parts.get(index, b""))
            parts[index] = payload
            while self._bytes > self._max_bytes and len(self._parts) > 1:
                self._drop(next(other for other in self._parts if other != name))
            if self._bytes > self._max_bytes:
                self._bytes -= len(parts.pop(index))

    def get(self, name: str, index: int) -> bytes | None:
        with self._lock:
            return self._parts.get(name, {}).get(index)

    def discard(self, name: str) -> None:
        with self._lock:
            self._drop(name)

    def clear(self) -> None:
        with self._lock:
            self._parts.clear()
            self._bytes = 0

    def _drop(self, name: str) -> None:
        self._bytes -= sum(map(len, self._parts.pop(name, {}).values()))


def _cut(data: bytes, index: int) -> bytes:
    return data[index * CHUNK_BYTES : (index + 1) * CHUNK_BYTES]


def _sizes(refs: Iterable[TensorRef]) -> dict[str, int]:
    wanted = {ref.sha256: ref.size_bytes for ref in refs}
    total = sum(wanted.values())
    if total > MAX_TOTAL_BYTES:
        raise MessageError(f"a version of {total} bytes is too large: at most {MAX_TOTAL_BYTES}")
    return wanted


def _wait(name: str, deadline: float) -> None:
    if time.monotonic() >= deadline:
        raise NoAnswerError(f"tensor {name} did not come in time")
    time.sleep(min(_PAUSE_S, max(0.0, deadline - time.monotonic())))
