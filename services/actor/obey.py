"""Obey: corrections come in on bus threads, and take force in the control thread.

The bus thread waits for the receipt, so that the answer to a correction is what became of it.
"""

import queue
import threading
from collections import OrderedDict
from collections.abc import Callable
from concurrent.futures import Future
from concurrent.futures import TimeoutError as FutureTimeout
from typing import NamedTuple

from shared.errors import RefusedError
from shared.messages.correction import Correction
from shared.messages.receipt import Receipt
from shared.wire.bus import Bus
from shared.wire.codec import decode, encode
from shared.wire.keys import robot_key

ANSWER_WITHIN_S = 10.0  # Longer than anybody asks: whoever asks again finds the receipt.
REMEMBERED = 4096


class _Waiting(NamedTuple):
    correction: Correction
    receipt: Future[Receipt]


class Inbox:
    """The corrections of one robot, from any bus thread to its control thread."""

    def __init__(
        self, bus: Bus, fleet: str, robot: str, wake: threading.Event, capacity: int = 64
    ) -> None:
        """wake: set when something has come, so that a control loop may sleep until then."""
        self._wake = wake
        self._waiting: queue.Queue[_Waiting] = queue.Queue(capacity)
        self._receipts: OrderedDict[str, Receipt] = OrderedDict()
        self._subscription = bus.serve(robot_key(fleet, robot, "correction"), self._answer)

    def obey(self, correct: Callable[[Correction], Receipt]) -> None:
        """In the control thread: pass everything that has come to `correct`, never waiting."""
        while True:
            try:
                correction, answer = self._waiting.get_nowait()
            except queue.Empty:
                return
            receipt = self._receipts.get(correction.id) or correct(correction)
            self._remember(receipt)
            if answer.set_running_or_notify_cancel():
                answer.set_result(receipt)

    def close(self) -> None:
        """Take no more corrections."""
        self._subscription.close()

    def _answer(self, key: str, payload: bytes) -> bytes:
        del key  # Unused: the key is this robot's.
        waiting = _Waiting(decode(Correction, payload), Future())
        try:
            self._waiting.put_nowait(waiting)
            self._wake.set()
            return encode(waiting.receipt.result(ANSWER_WITHIN_S))
        except queue.Full:
            raise RefusedError("too many corrections are waiting; send it again") from None
        except FutureTimeout:
            raise RefusedError("the control loop of this robot stands still") from None

    def _remember(self, receipt: Receipt) -> None:
        self._receipts[receipt.correction] = receipt
        while len(self._receipts) > REMEMBERED:
            self._receipts.popitem(last=False)
