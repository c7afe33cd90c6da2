"""Record: decisions and episodes are kept until the learner has them, and shown to who watches."""

import queue
import threading

from shared.messages.decision import Decision
from shared.messages.episode import Episode
from shared.wire.bus import Bus
from shared.wire.codec import encode
from shared.wire.delivery import Courier
from shared.wire.keys import robot_key
from shared.wire.outbox import Outbox

CAPACITY = 256
FAREWELL_S = 2.0


class Recorder:
    """Puts records into the outbox for the learner, then on the bus for those who watch.

    A thread of its own writes, since a disk may take longer than a control step. When the disk
    falls `CAPACITY` records behind, the robot waits for it: a record is never thrown away.
    """

    def __init__(self, bus: Bus, outbox: Outbox, courier: Courier, fleet: str) -> None:
        self._bus, self._outbox, self._courier, self._fleet = bus, outbox, courier, fleet
        self._waiting: queue.Queue[Decision | Episode | None] = queue.Queue(CAPACITY)
        self._thread = threading.Thread(target=self._run, name="recorder", daemon=True)
        self._thread.start()

    @property
    def pending(self) -> int:
        """Records that the learner has not acknowledged yet."""
        return self._waiting.qsize() + len(self._outbox)

    def decided(self, decision: Decision) -> None:
        """Keep a decision and show it."""
        self._waiting.put(decision)

    def ended(self, episode: Episode) -> None:
        """Keep an episode and show it."""
        self._waiting.put(episode)

    def repeat(self, decision: Decision) -> None:
        """Show a decision again, for whoever came late; the learner's copy is not touched."""
        self._bus.put(self._key(decision), encode(decision))

    def close(self, farewell_s: float = FAREWELL_S) -> None:
        """Write what waits, and give the learner a moment to take it; the rest stays on disk."""
        self._waiting.put(None)
        self._thread.join()
        self._courier.drained(farewell_s)

    def _run(self) -> None:
        while (record := self._waiting.get()) is not None:
            payload = encode(record)
            self._outbox.add(record.id, self._key(record), payload)
            self._courier.wake()
            self._bus.put(self._key(record), payload)

    def _key(self, record: Decision | Episode) -> str:
        message = "decision" if isinstance(record, Decision) else "episode"
        return robot_key(self._fleet, record.robot, message)
