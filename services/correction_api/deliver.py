"""Deliver: asks each robot, correction after correction, until it gives its receipt.

One line a robot, so that what was said first is obeyed first; a robot that does not answer holds
up nobody but itself. What has no receipt after `expire_s` is given up: nobody wants a robot that
comes back to obey what was said minutes ago.
"""

import asyncio
from collections import deque
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor

import structlog

from services.correction_api.config import DeliverySettings
from services.correction_api.store.log import Closed, Entry, Log
from services.correction_api.store.writer import StoreError
from shared.clock import Clock
from shared.errors import HldError, MessageError
from shared.messages.receipt import Receipt
from shared.wire.bus import Bus, Urgency
from shared.wire.codec import decode, encode
from shared.wire.keys import robot_key

log = structlog.get_logger()


class Messenger:
    """Takes corrections to their robots. Everything but `ask` runs on the event loop.

    closed: called on the event loop with each entry that got its receipt or expired, and with
        the one that it ended.
    """

    def __init__(
        self,
        bus: Bus,
        fleet: str,
        kept: Log,
        clock: Clock,
        settings: DeliverySettings,
        closed: Callable[[Closed], None],
    ) -> None:
        self._bus, self._fleet, self._log, self._clock = bus, fleet, kept, clock
        self._settings, self._closed = settings, closed
        self._lines: dict[str, deque[Entry]] = {}
        self._tasks: set[asyncio.Task[None]] = set()
        self._pool = ThreadPoolExecutor(settings.asking, thread_name_prefix="ask")

    def send(self, entries: Iterable[Entry]) -> None:
        """Put entries at the end of the lines of their robots."""
        for entry in entries:
            robot = entry.correction.robot
            if robot in self._lines:
                self._lines[robot].append(entry)
                continue
            self._lines[robot] = deque([entry])
            task = asyncio.get_running_loop().create_task(self._work(robot))
            self._tasks.add(task)
            task.add_done_callback(self._tasks.discard)

    def __len__(self) -> int:
        """Corrections that wait for a receipt."""
        return sum(len(line) for line in self._lines.values())

    async def close(self) -> None:
        """Stop asking; what has no receipt stays on disk, and is asked again after a restart."""
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        self._pool.shutdown(wait=False, cancel_futures=True)

    async def _work(self, robot: str) -> None:
        line = self._lines[robot]
        while line:
            await self._deliver(line[0])
            line.popleft()
        del self._lines[robot]

    async def _deliver(self, entry: Entry) -> None:
        pause_s = self._settings.retry_s
        while not await self._attempt(entry):
            await asyncio.sleep(pause_s)
            pause_s = min(2 * pause_s, self._settings.retry_max_s)

    async def _attempt(self, entry: Entry) -> bool:
        """True when the entry is closed, and on disk as such."""
        age_ns = self._clock.now_ns() - entry.correction.created_ns
        try:
            if age_ns > self._settings.expire_s * 1e9:
                reason = f"the robot gave no receipt within {self._settings.expire_s:g} s"
                future = self._log.expire(entry.correction, reason)
            else:
                future = self._log.answer(await self._ask(entry))
            closed = await asyncio.wrap_future(future)
        except StoreError as error:
            log.error(
                "a receipt could not be kept", correction=entry.correction.id, reason=str(error)
            )
            return False
        except HldError as error:
            log.info("no receipt yet", correction=entry.correction.id, reason=str(error))
            return False
        except Exception:  # A fault of ours: the line of this robot must not stand still for it.
            log.exception("a correction was not delivered", correction=entry.correction.id)
            return False
        if closed:
            self._closed(closed)
        return True

    async def _ask(self, entry: Entry) -> Receipt:
        correction = entry.correction
        key = robot_key(self._fleet, correction.robot, "correction")
        payload = encode(correction)

        def ask() -> bytes:
            return self._bus.ask(
                key, payload, timeout_s=self._settings.ask_s, urgency=Urgency.REAL_TIME
            )

        answer = await asyncio.get_running_loop().run_in_executor(self._pool, ask)
        receipt = decode(Receipt, answer)
        if (receipt.correction, receipt.robot) != (correction.id, correction.robot):
            raise MessageError(f"a receipt for {receipt.correction} of {receipt.robot}")
        return receipt
