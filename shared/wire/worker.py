"""A thread with a bounded queue: what stands between the network's threads and a handler."""

import threading
from collections import deque
from collections.abc import Callable
from typing import Generic, TypeVar

import structlog

T = TypeVar("T")


class Worker(Generic[T]):
    """Handles items one after the other in a thread of its own; never blocks who offers.

    newest: a full queue drops the oldest waiting item (else the one that comes); both count.
    idle: called in the worker's thread whenever `idle_s` pass without an item, and at once when
        the worker is nudged.
    """

    def __init__(
        self,
        name: str,
        handle: Callable[[T], None],
        *,
        capacity: int,
        newest: bool = True,
        idle: Callable[[], None] | None = None,
        idle_s: float | None = None,
    ) -> None:
        if capacity < 1:
            raise ValueError(f"a queue holds at least 1, not {capacity}")
        self._name = name
        self._handle = handle
        self._capacity = capacity
        self._newest = newest
        self._idle = idle
        self._idle_s = idle_s
        self._items: deque[T] = deque()
        self._nudged = False
        self._closed = False
        self._dropped = 0
        self._changed = threading.Condition()
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)
        self._thread.start()

    @property
    def dropped(self) -> int:
        """Items that found the queue full or couldn't be handled, so far."""
        return self._dropped

    def offer(self, item: T) -> bool:
        """Queue an item; False when it was this very item that had to be dropped."""
        with self._changed:
            if self._closed:
                return False
            if len(self._items) >= self._capacity:
                self._dropped += 1
                if not self._newest:
                    return False
                self._items.popleft()
            self._items.append(item)
            self._changed.notify()
            return True

    def drop(self) -> None:
        """Count an item that can't be handled as dropped."""
        with self._changed:
            self._dropped += 1

    def nudge(self) -> None:
        """Call `idle` soon."""
        with self._changed:
            self._nudged = True
            self._changed.notify()

    def close(self, timeout_s: float = 2.0) -> None:
        """Forget what waits, and wait until the item in hand is done (or the time is out)."""
        with self._changed:
            self._closed = True
            self._items.clear()
            self._changed.notify()
        if self._thread is not threading.current_thread():
            self._thread.join(timeout_s)

    def _run(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(self._wanted, self._idle_s)
                if self._closed:
                    return
                item = [self._items.popleft()] if self._items and not self._nudged else []
                self._nudged = False
            self._do(item)

    def _wanted(self) -> bool:
        return bool(self._items) or self._nudged or self._closed

    def _do(self, item: list[T]) -> None:
        try:
            if item:
                self._handle(item[0])
            elif self._idle:
                self._idle()
        except Exception:
            structlog.get_logger().exception("a handler failed", handler=self._name)
