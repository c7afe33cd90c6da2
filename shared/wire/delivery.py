"""Carries what may not be lost: each parcel is asked again until the other side says `ok`.

At least once by repeating, once by the parcel's id (the receiver knows it again), in order since
the next one leaves only when the one before was answered.
"""

import threading

import structlog

from shared.clock import Clock
from shared.errors import MessageError, NoAnswerError, RefusedError
from shared.wire.bus import INTERNAL_ERROR, Bus, Urgency
from shared.wire.closing import Closing
from shared.wire.outbox import OutboxLike, Parcel

OK = b"ok"

_MS = 1_000_000
_BACKOFF_NS = (200 * _MS, 2000 * _MS)
_BATCH = 100
_PATIENCE = 30  # tries of a parcel that breaks the receiver: about a minute
_LOOK_S = 0.05  # how often a waiting courier looks at its clock


class Courier(Closing):
    """A thread that empties an outbox over the bus, oldest first.

    Answered `ok`: done. Refused: kept aside with the reason, counted, and the next one leaves.
    No answer: tried again, after 0.2 s first and 2 s at most. An internal error of the receiver
    is tried again too, and refused only after 30 tries, so that one poisoned record can't hold
    the others back for ever.
    """

    def __init__(
        self,
        bus: Bus,
        outbox: OutboxLike,
        clock: Clock,
        *,
        timeout_s: float = 2.0,
        urgency: Urgency = Urgency.NORMAL,
    ) -> None:
        self._bus = bus
        self._outbox = outbox
        self._clock = clock
        self._timeout_s = timeout_s
        self._urgency = urgency
        self._log = structlog.get_logger()
        self._changed = threading.Condition()
        self._new = True
        self._closed = False
        self._tries = 0
        self._delivered = 0
        self._refused = 0
        self._thread = threading.Thread(target=self._run, name="courier", daemon=True)
        self._thread.start()

    @property
    def delivered(self) -> int:
        """Parcels that were answered `ok`, since this courier began."""
        return self._delivered

    @property
    def refused(self) -> int:
        """Parcels that were kept aside, since this courier began."""
        return self._refused

    def wake(self) -> None:
        """Something was added: look now."""
        with self._changed:
            self._new = True
            self._changed.notify_all()

    def drained(self, timeout_s: float) -> bool:
        """Wait until nothing waits any more; False when the time is out."""
        self.wake()
        with self._changed:
            return self._changed.wait_for(lambda: len(self._outbox) == 0, timeout_s)

    def close(self) -> None:
        """End the thread after the question in hand; what waits stays in the outbox."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()
        if self._thread is not threading.current_thread():
            self._thread.join()

    def _run(self) -> None:
        while self._wait_for_work():
            try:
                delivered_all = self._empty()
            except Exception:
                # A full disk, say: the outbox is as it was, and the next try may succeed.
                self._log.exception("the outbox failed")
                delivered_all = False
            if not delivered_all:
                self._back_off()

    def _wait_for_work(self) -> bool:
        with self._changed:
            self._changed.wait_for(lambda: self._new or self._closed)
            self._new = False
            return not self._closed

    def _empty(self) -> bool:
        """Deliver until nothing waits (True) or somebody must be waited for (False)."""
        while parcels := self._outbox.pending(_BATCH):
            for parcel in parcels:
                if self._closed or not self._deliver(parcel):
                    return False
                self._tries = 0
        with self._changed:
            self._changed.notify_all()
        return True

    def _deliver(self, parcel: Parcel) -> bool:
        """True when the parcel needn't be tried again."""
        try:
            answer = self._bus.ask(
                parcel.key, parcel.payload, timeout_s=self._timeout_s, urgency=self._urgency
            )
        except NoAnswerError:
            self._tries += 1
            return False
        except (RefusedError, MessageError) as error:
            return self._give_up(parcel, str(error))
        if answer != OK:
            return self._give_up(parcel, INTERNAL_ERROR)
        self._outbox.done(parcel.id)
        self._delivered += 1
        return True

    def _give_up(self, parcel: Parcel, reason: str) -> bool:
        self._tries += 1
        if reason == INTERNAL_ERROR and self._tries < _PATIENCE:
            return False
        self._log.warning("refused", id=parcel.id, key=parcel.key, reason=reason)
        self._outbox.refuse(parcel.id, reason)
        self._refused += 1
        return True

    def _back_off(self) -> None:
        first, most = _BACKOFF_NS
        wait_ns = min(first << min(max(self._tries - 1, 0), 10), most)
        until_ns = self._clock.monotonic_ns() + wait_ns
        with self._changed:
            while not self._closed and self._clock.monotonic_ns() < until_ns:
                self._changed.wait(_LOOK_S)
            self._new = True
