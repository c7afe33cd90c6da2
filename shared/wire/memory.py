"""The bus within one process, by the same contract: for tests, and where no router is."""

import threading
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import structlog

from shared.errors import HldError, NoAnswerError, RefusedError
from shared.wire import keys as names
from shared.wire.bus import (
    INTERNAL_ERROR,
    AliveHandler,
    Answer,
    Bus,
    Handler,
    Urgency,
    check_payload,
)
from shared.wire.closing import Closing
from shared.wire.hub import MemoryRouter, MemorySubscription
from shared.wire.worker import Worker


class _Question(NamedTuple):
    key: str
    payload: bytes
    answer: Callable[[bytes | None, str | None], None]


class MemoryBus(Closing):
    """`Bus` over a `MemoryRouter`; without one given it is alone."""

    def __init__(self, router: MemoryRouter | None = None) -> None:
        self._router = router or MemoryRouter()
        self._entries: list[MemorySubscription] = []
        self._kept: set[str] = set()
        self._tokens: list[str] = []
        self._closed = False

    def put(
        self,
        key: str,
        payload: bytes,
        urgency: Urgency = Urgency.NORMAL,
        *,
        droppable: bool = False,
    ) -> None:
        del urgency, droppable  # Unused: nothing waits in a queue of the network's here.
        check_payload(names.check_key(key), payload)
        if not self._closed:
            self._router.put(key, payload)

    def subscribe(
        self, keys: str, handler: Handler, *, capacity: int = 256, newest: bool = True
    ) -> MemorySubscription:
        def handle(item: tuple[str, bytes]) -> None:
            handler(*item)

        names.check_pattern(keys)
        worker = Worker(f"subscribe {keys}", handle, capacity=capacity, newest=newest)
        return self._add("put", keys, worker)

    def serve(self, keys: str, handler: Answer, *, capacity: int = 1024) -> MemorySubscription:
        def handle(question: _Question) -> None:
            question.answer(*_reply(question, handler))

        names.check_pattern(keys)
        worker = Worker(f"serve {keys}", handle, capacity=capacity, newest=False)
        return self._add("serve", keys, worker)

    def ask(
        self,
        key: str,
        payload: bytes = b"",
        *,
        timeout_s: float = 2.0,
        urgency: Urgency = Urgency.NORMAL,
    ) -> bytes:
        del urgency  # Unused, as above.
        check_payload(names.check_pattern(key), payload)
        kept = None if self._closed else self._router.kept(key)
        if kept is not None:
            return kept
        answers = _Answers()
        servers = [] if self._closed else self._router.servers(key)
        for server in servers:
            answers.expect(server.worker.offer(_Question(key, payload, answers.take)))
        return answers.wait(key, timeout_s)

    def latest(self, key: str, payload: bytes) -> None:
        check_payload(names.check_key(key), payload)
        if not self._closed:
            self._kept.add(key)
            self._router.keep(key, payload, self)

    def follow(self, keys: str, handler: Handler) -> MemorySubscription:
        seen: dict[str, int] = {}

        def handle(item: tuple[str, int, bytes]) -> None:
            key, count, payload = item
            if count == 0 or count > seen.get(key, 0):
                seen[key] = max(count, seen.get(key, 0))
                handler(key, payload)

        names.check_pattern(keys)
        return self._add("follow", keys, Worker(f"follow {keys}", handle, capacity=64))

    def watched(self, key: str) -> bool:
        return not self._closed and self._router.watched(names.check_key(key))

    def alive(self, key: str) -> None:
        self._check_open()
        self._tokens.append(names.check_key(key))
        self._router.live(key, +1)

    def watch_alive(self, keys: str, handler: AliveHandler) -> MemorySubscription:
        known: set[str] = set()

        def handle(item: tuple[str, bool]) -> None:
            key, lives = item
            if lives != (key in known):
                (known.add if lives else known.discard)(key)
                handler(key, lives)

        names.check_pattern(keys)
        return self._add("alive", keys, Worker(f"watch {keys}", handle, capacity=4096))

    @property
    def connected(self) -> bool:
        return not self._closed and self._router.running

    def joined(self, timeout_s: float) -> bool:
        deadline = time.monotonic() + timeout_s
        while not self.connected and time.monotonic() < deadline:
            time.sleep(0.01)
        return self.connected

    def close(self) -> None:
        if self._closed:
            return
        self._closed = True
        for entry in self._entries:
            entry.close()
        for key in self._kept:
            self._router.forget(key, self)
        for key in self._tokens:
            self._router.live(key, -1)

    def _add(self, kind: str, keys: str, worker: Worker[Any]) -> MemorySubscription:
        try:
            self._check_open()
        except NoAnswerError:
            worker.close()
            raise
        entry = MemorySubscription(self._router, kind, keys, worker)
        self._entries.append(entry)
        return entry

    def _check_open(self) -> None:
        if self._closed:
            raise NoAnswerError("the bus is closed")


class _Answers:
    """What came back for one question: the first answer ends it, refusals wait for the rest."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._expected = 0
        self._answer: bytes | None = None
        self._refusal: str | None = None

    def expect(self, asked: bool) -> None:
        with self._changed:
            self._expected += asked

    def take(self, answer: bytes | None, refusal: str | None) -> None:
        with self._changed:
            self._expected -= 1
            self._answer = answer if self._answer is None else self._answer
            self._refusal = refusal or self._refusal
            self._changed.notify()

    def wait(self, key: str, timeout_s: float) -> bytes:
        with self._changed:
            self._changed.wait_for(
                lambda: self._answer is not None or self._expected <= 0, timeout_s
            )
            if self._answer is not None:
                return self._answer
            if self._refusal is not None:
                raise RefusedError(self._refusal)
        raise NoAnswerError(f"{key}: nobody answered within {timeout_s:g} s")


def _reply(question: _Question, handler: Answer) -> tuple[bytes | None, str | None]:
    try:
        reply = handler(question.key, question.payload)
        check_payload(question.key, reply)
        return reply, None
    except HldError as error:
        return None, str(error)
    except Exception:
        structlog.get_logger().exception("a handler failed", key=question.key)
        return None, INTERNAL_ERROR


if TYPE_CHECKING:
    _conforms: type[Bus] = MemoryBus  # Here mypy holds the fake against the protocol.
