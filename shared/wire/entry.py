"""What was asked of a Zenoh bus, and outlives the lack of a session."""

from collections.abc import Callable
from typing import Any, Protocol

import zenoh

from shared.wire.worker import Worker


class Declared(Protocol):
    """A Zenoh entity that lasts until it is undeclared."""

    def undeclare(self) -> None: ...


Declare = Callable[[zenoh.Session], Declared]


class Entry:
    """One thing that was asked of the bus: its Zenoh entity, once there is one, and its worker."""

    def __init__(
        self, declare: Declare, worker: Worker[Any] | None, forget: Callable[["Entry"], None]
    ) -> None:
        self._declare = declare
        self._worker = worker
        self._forget = forget
        self._entity: Declared | None = None

    @property
    def dropped(self) -> int:
        return self._worker.dropped if self._worker else 0

    def attach(self, session: zenoh.Session) -> None:
        self._entity = self._declare(session)
        if self._worker:
            self._worker.nudge()

    def close(self) -> None:
        self._forget(self)
        entity, self._entity = self._entity, None
        if entity is not None:
            entity.undeclare()
        if self._worker:
            self._worker.close()
