"""Inquire: which version learned what people said? Asked of the learner whenever it announces one.

What it answered is kept with the log. A learner that doesn't answer is asked again, and one that
comes with another version later is asked about all that has not been learned yet.
"""

import asyncio
from collections.abc import Callable, Iterable

import structlog

from services.correction_api.store.lessons import Lessons
from services.correction_api.store.log import Entry
from services.correction_api.store.writer import StoreError
from services.correction_api.watch import Watch
from shared.errors import HldError
from shared.messages.learned import MAX_ASKED, LearnedAnswer, LearnedQuestion
from shared.messages.policy import Version
from shared.wire.bus import Bus
from shared.wire.codec import decode, encode
from shared.wire.keys import any_service

LOOK_S = 0.5
ASK_S = 5.0
LONGEST_PAUSE_S = 10.0
log = structlog.get_logger()


class Inquirer:
    """Asks in pages of `MAX_ASKED` corrections, in a thread beside the event loop."""

    def __init__(
        self,
        bus: Bus,
        fleet: str,
        watch: Watch,
        lessons: Lessons,
        learned: Callable[[Iterable[Entry]], None],
    ) -> None:
        """learned: told on the event loop of every correction of which something new is known."""
        self._bus, self._watch, self._lessons = bus, watch, lessons
        self._learned = learned
        self._key = any_service(fleet, "learner", "learned")
        self._asked: Version | None = None

    async def work(self) -> None:
        """Ask for ever, at each version that is announced."""
        pause_s = LOOK_S
        while True:
            announced = self._watch.announcement
            if announced and announced.version != self._asked:
                pause_s = min(2 * pause_s, LONGEST_PAUSE_S)
                if await self._ask_all():
                    self._asked, pause_s = announced.version, LOOK_S
            await asyncio.sleep(pause_s)

    async def _ask_all(self) -> bool:
        """Whether the learner answered all there is to ask."""
        after = 0
        try:
            while names := await asyncio.to_thread(self._lessons.open, after, MAX_ASKED):
                answer = await asyncio.to_thread(self._ask, tuple(names.values()))
                entries = await asyncio.wrap_future(self._lessons.keep(answer))
                self._learned(entries)
                after = max(names)
        except (HldError, StoreError) as error:
            log.info("the learner does not tell yet what it learned", reason=str(error))
            return False
        except Exception:  # A fault of ours: the next version must be asked about all the same.
            log.exception("what was learned could not be found out")
            return False
        return True

    def _ask(self, names: tuple[str, ...]) -> LearnedAnswer:
        payload = encode(LearnedQuestion(corrections=names))
        return decode(LearnedAnswer, self._bus.ask(self._key, payload, timeout_s=ASK_S))
