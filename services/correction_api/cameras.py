"""Cameras: pictures are asked for only while a page looks at them, and passed on as they come."""

import json
import queue
import threading
from collections.abc import Callable

import structlog

from services.correction_api.live import View
from services.correction_api.metrics import Metrics
from shared.errors import HldError, MessageError
from shared.messages.frame import Channel, Frame
from shared.wire.bus import Bus, Subscription
from shared.wire.codec import decode
from shared.wire.keys import parse, robot_key

QUEUED_FRAMES = 2
log = structlog.get_logger()


class Cameras:
    """Holds one subscription per camera and rate that somebody looks at.

    Subscribing may wait for the network, so it is done in a thread of its own.
    """

    def __init__(
        self, bus: Bus, fleet: str, show: Callable[[View, bytes], None], metrics: Metrics
    ) -> None:
        self._bus, self._fleet, self._show, self._metrics = bus, fleet, show, metrics
        self._subscriptions: dict[View, Subscription] = {}
        self._wanted: queue.SimpleQueue[frozenset[View] | None] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._run, name="cameras", daemon=True)
        self._thread.start()

    def want(self, views: frozenset[View]) -> None:
        """Look at these cameras from now on, and at no others. Any thread; never waits."""
        self._wanted.put(views)

    def close(self) -> None:
        """Look at nothing any more."""
        self._wanted.put(None)
        self._thread.join()

    def _run(self) -> None:
        while (views := self._newest()) is not None:
            try:
                self._turn(views)
            except HldError as error:
                log.warning("the cameras could not be turned", reason=str(error))
        self._turn(frozenset())

    def _newest(self) -> frozenset[View] | None:
        views = self._wanted.get()
        while views is not None and not self._wanted.empty():
            views = self._wanted.get()
        return views

    def _turn(self, views: frozenset[View]) -> None:
        for view in self._subscriptions.keys() - views:
            self._subscriptions.pop(view).close()
        for view in views - self._subscriptions.keys():
            channel = Channel(view.camera, view.rate)
            key = robot_key(self._fleet, view.robot, channel.message)
            self._subscriptions[view] = self._bus.subscribe(key, self._take, capacity=QUEUED_FRAMES)

    def _take(self, key: str, payload: bytes) -> None:
        try:
            picture = pack(decode(Frame, payload))
        except MessageError as error:
            self._metrics.unreadable.inc()
            log.warning("a picture was not understood", key=key, reason=str(error))
            return
        self._metrics.frames.inc()
        address = parse(key)
        self._show(View(address.id, *Channel.parse(address.message)), picture)


def pack(frame: Frame) -> bytes:
    """A picture for the page: length of the head (2 bytes, big-endian), head as JSON, JPEG."""
    head = json.dumps(frame.without_arrays() | {"type": "frame"}).encode()
    return len(head).to_bytes(2, "big") + head + frame.arrays["jpeg"].tobytes()
