"""The bus between processes: one Zenoh session, a client of the router.

The session opens in the background and is opened again until it succeeds, so that services may
start before the router and end without one. What is asked of the bus meanwhile is kept and
declared then; after a lost connection Zenoh itself declares it again.
"""

import contextlib
import threading
from typing import Any

import structlog
import zenoh
from zenoh.handlers import Callback

from shared.errors import NoAnswerError
from shared.wire import questions
from shared.wire.bus import (
    AliveHandler,
    Answer,
    BusSettings,
    Handler,
    Urgency,
    check_payload,
)
from shared.wire.closing import Closing
from shared.wire.entry import Declare, Entry
from shared.wire.kept import Followed, Kept
from shared.wire.keys import check_key, check_pattern
from shared.wire.link import client_config
from shared.wire.worker import Worker

_RETRY_S = 0.1
_GOODBYE_S = 2.0
_COMPLAIN_EVERY = 20  # tries, so about every 12 s


class ZenohBus(Closing):
    """`Bus` over Zenoh. Open it by `shared.wire.bus.open_bus`, and always close it."""

    def __init__(self, settings: BusSettings) -> None:
        self._config = client_config(settings)
        self._endpoints = ", ".join(settings.connect)
        self._log = structlog.get_logger()
        self._lock = threading.RLock()
        self._session: zenoh.Session | None = None
        self._entries: list[Entry] = []
        self._kept: dict[str, Kept] = {}
        self._publishers: dict[str, zenoh.Publisher] = {}
        self._ended = threading.Event()
        self._opened = threading.Event()
        self._opener = threading.Thread(target=self._join, name="bus-open", daemon=True)
        self._opener.start()

    def put(
        self,
        key: str,
        payload: bytes,
        urgency: Urgency = Urgency.NORMAL,
        *,
        droppable: bool = False,
    ) -> None:
        check_payload(check_key(key), payload)
        self._put(key, payload, urgency, droppable, None)

    def subscribe(
        self, keys: str, handler: Handler, *, capacity: int = 256, newest: bool = True
    ) -> Entry:
        def handle(sample: zenoh.Sample) -> None:
            if questions.is_message(sample):
                handler(str(sample.key_expr), sample.payload.to_bytes())
            else:
                worker.drop()

        check_pattern(keys)
        worker = Worker(f"subscribe {keys}", handle, capacity=capacity, newest=newest)
        return self._add(lambda session: session.declare_subscriber(keys, worker.offer), worker)

    def serve(self, keys: str, handler: Answer, *, capacity: int = 1024) -> Entry:
        def handle(query: zenoh.Query) -> None:
            with query:
                questions.answer(query, handler)

        check_pattern(keys)
        worker = Worker(f"serve {keys}", handle, capacity=capacity, newest=False)
        offer = questions.offer_to(worker)
        return self._add(lambda session: session.declare_queryable(keys, offer), worker)

    def ask(
        self,
        key: str,
        payload: bytes = b"",
        *,
        timeout_s: float = 2.0,
        urgency: Urgency = Urgency.NORMAL,
    ) -> bytes:
        check_payload(check_pattern(key), payload)
        session = self._session
        if session is None:
            raise NoAnswerError(f"{key}: there is no router at {self._endpoints} yet")
        return questions.ask(session, key, payload, timeout_s, urgency)

    def latest(self, key: str, payload: bytes) -> None:
        check_payload(check_key(key), payload)
        with self._lock:
            kept = self._kept.setdefault(key, Kept(key))
            first = not kept.stamp
            kept.keep(payload)
            if first:
                worker = Worker(f"latest {key}", kept.answer, capacity=64, newest=False)
                offer = questions.offer_to(worker)
                self._add(lambda session: session.declare_queryable(key, offer), worker)
            # Inside the lock, so that two values never leave in the other order.
            self._put(key, payload, Urgency.NORMAL, False, kept.stamp)

    def follow(self, keys: str, handler: Handler) -> Entry:
        def refresh() -> None:
            if self._session is not None:
                followed.refresh(self._session, worker.offer)

        followed = Followed(check_pattern(keys), handler)
        worker = Worker(
            f"follow {keys}",
            followed.handle,
            capacity=64,
            idle=refresh,
            idle_s=Followed.REFRESH_S,
        )
        # Direct, as the answers to a refresh come: so that neither overtakes the other.
        direct = Callback(worker.offer, indirect=False)
        return self._add(lambda session: session.declare_subscriber(keys, direct), worker)

    def watched(self, key: str) -> bool:
        check_key(key)
        with self._lock:
            if self._session is None:
                return False
            if key not in self._publishers:
                self._publishers[key] = self._session.declare_publisher(key)
            # The stub says bool; it is an object (1.10.2).
            status: Any = self._publishers[key].matching_status
            return bool(status.matching)

    def alive(self, key: str) -> None:
        check_key(key)
        self._add(lambda session: session.liveliness().declare_token(key), None)

    def watch_alive(self, keys: str, handler: AliveHandler) -> Entry:
        known: set[str] = set()

        def handle(sample: zenoh.Sample) -> None:
            key, lives = str(sample.key_expr), sample.kind == zenoh.SampleKind.PUT
            if lives != (key in known):
                (known.add if lives else known.discard)(key)
                handler(key, lives)

        check_pattern(keys)
        worker = Worker(f"watch {keys}", handle, capacity=4096)
        return self._add(
            lambda session: session.liveliness().declare_subscriber(
                keys, worker.offer, history=True
            ),
            worker,
        )

    @property
    def connected(self) -> bool:
        session = self._session
        try:
            return session is not None and bool(session.info.routers_zid())
        except zenoh.ZError:
            return False

    def joined(self, timeout_s: float) -> bool:
        return self._opened.wait(timeout_s)

    def close(self) -> None:
        self._ended.set()
        self._opener.join()
        for entry in list(self._entries):
            entry.close()
        with self._lock:
            session, self._session = self._session, None
        if session is not None:
            self._leave(session)

    def _join(self) -> None:
        tries = 0
        while not self._ended.is_set():
            try:
                session = zenoh.open(self._config)
            except zenoh.ZError as error:
                if tries % _COMPLAIN_EVERY == 0:
                    reason = str(error).split(" at /")[0]  # Without the place in Zenoh's source.
                    self._log.warning("no router yet", endpoints=self._endpoints, error=reason)
                tries += 1
                self._ended.wait(_RETRY_S)
            else:
                self._begin(session)
                return

    def _begin(self, session: zenoh.Session) -> None:
        with self._lock:
            self._session = session
            for entry in self._entries:
                entry.attach(session)
        self._opened.set()

    def _leave(self, session: zenoh.Session) -> None:
        """Say goodbye; a router that hangs isn't waited for, as Zenoh would for 10 s."""

        def close() -> None:
            # All that Zenoh has to say here is that the router did not listen.
            with contextlib.suppress(zenoh.ZError):
                session.close()  # type: ignore[no-untyped-call]  # Its stub has no types here.

        closing = threading.Thread(target=close, name="bus-close", daemon=True)
        closing.start()
        closing.join(_GOODBYE_S)

    def _add(self, declare: Declare, worker: Worker[Any] | None) -> Entry:
        entry = Entry(declare, worker, self._forget)
        with self._lock:
            if not self._ended.is_set():
                self._entries.append(entry)
                if self._session is not None:
                    entry.attach(self._session)
                return entry
        entry.close()
        raise NoAnswerError("the bus is closed")

    def _forget(self, entry: Entry) -> None:
        with self._lock:
            if entry in self._entries:
                self._entries.remove(entry)

    def _put(
        self, key: str, payload: bytes, urgency: Urgency, droppable: bool, stamp: bytes | None
    ) -> None:
        session = self._session
        if session is None:
            return
        congestion = zenoh.CongestionControl
        try:
            session.put(
                key,
                payload,
                congestion_control=congestion.DROP if droppable else congestion.BLOCK,
                priority=questions.PRIORITY[urgency],
                express=urgency is Urgency.REAL_TIME,
                attachment=stamp,
            )
        except zenoh.ZError as error:
            self._log.warning("not sent", key=key, error=str(error)[:200])
