"""Wakes coroutines from any thread; however often it rings, once a turn of the event loop."""

import asyncio
import threading


class Bell:
    """Take the event before looking at the state, then wait for it: no ring can be missed.

    silence: from now on everybody is woken at once, so that nobody holds up the end.
    """

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._event = asyncio.Event()
        self._lock = threading.Lock()
        self._rung = self.silenced = False

    @property
    def event(self) -> asyncio.Event:
        """Will be set at the next ring. Event loop's thread only."""
        return self._event

    def ring(self) -> None:
        """Wake everybody who waits. Any thread."""
        with self._lock:
            if self._rung or self.silenced:
                return
            self._rung = True
            self._loop.call_soon_threadsafe(self._wake)

    def silence(self) -> None:
        """Wake everybody for the last time. Event loop's thread only."""
        with self._lock:
            self.silenced = True
        self._event.set()

    def _wake(self) -> None:
        with self._lock:
            self._rung = False
        if not self.silenced:
            event, self._event = self._event, asyncio.Event()
            event.set()


async def wait(event: asyncio.Event, timeout_s: float) -> bool:
    """Whether the event was set in time."""
    try:
        async with asyncio.timeout(timeout_s):
            return await event.wait()
    except TimeoutError:
        return False
