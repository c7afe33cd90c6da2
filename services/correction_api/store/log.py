"""The log of what people said: appended once, closed once by a receipt, never rewritten."""

from collections.abc import Callable
from concurrent.futures import Future
from enum import StrEnum
from typing import Any, NamedTuple

from sqlalchemy import Connection, Engine, Row, Select, insert, select, update

from services.correction_api.store.parcels import send
from services.correction_api.store.tables import corrections
from services.correction_api.store.writer import Writer
from shared.messages.correction import AFTERWARDS, Correction
from shared.messages.receipt import Receipt


class Status(StrEnum):
    """What became of a correction: `expired` means that no robot ever answered; `kept`, that none
    had to, since it is about the past."""

    PENDING = "pending"
    IN_FORCE = "in force"
    REFUSED = "refused"
    EXPIRED = "expired"
    KEPT = "kept"


class Entry(NamedTuple):
    """One correction as the log has it.

    digest: of what the client sent. reason: why it was refused, or why it expired.
    """

    sequence: int
    correction: Correction
    status: Status
    digest: str
    receipt: Receipt | None
    reason: str


class Log:
    """Corrections on disk; writes go through the writer thread, reads through a pool."""

    def __init__(self, writer: Writer, readers: Engine, outbox_key: Callable[[str], str]) -> None:
        """outbox_key: at which key the learner takes a "correction" or a "receipt"."""
        self._writer, self._readers, self._outbox_key = writer, readers, outbox_key

    def append(
        self, correction: Correction, digest: str, status: Status = Status.PENDING
    ) -> Future[Entry]:
        """Keep a correction, and post it to the learner; the entry that is there wins.

        status: pending, or kept where no robot has to hear it.
        """

        def work(connection: Connection) -> Entry:
            if found := _find(connection, correction.id):
                return found
            values = _values(correction, digest, status)
            key = insert(corrections).values(values).returning(corrections.c.sequence)
            sequence = connection.execute(key).scalar_one()
            self._post(connection, correction.id, "correction", correction.model_dump_json())
            return Entry(sequence, correction, status, digest, None, "")

        return self._writer.submit(work)

    def answer(self, receipt: Receipt) -> Future[Entry | None]:
        """Close a correction by its receipt, and post that to the learner.

        The result is None when it was closed before, or was never opened.
        """

        def work(connection: Connection) -> Entry | None:
            status = Status.IN_FORCE if receipt.accepted else Status.REFUSED
            text = receipt.model_dump_json()
            entry = _close(connection, receipt.correction, status, receipt.reason, text)
            if entry:
                self._post(connection, receipt.correction, "receipt", text)
            return entry

        return self._writer.submit(work)

    def expire(self, correction: Correction, reason: str) -> Future[Entry | None]:
        """Close a correction that no robot answered; one about the past stays true all the same."""
        status = Status.KEPT if correction.kind in AFTERWARDS else Status.EXPIRED
        return self._writer.submit(
            lambda connection: _close(connection, correction.id, status, reason, None)
        )

    def probe(self) -> None:
        """See whether the disk takes anything.

        Raises:
            StoreError: it doesn't.
        """
        self._writer.submit(bool).result()  # A transaction in which nothing is done.

    def find(self, name: str) -> Entry | None:
        """The entry of the correction with this id."""
        with self._readers.connect() as connection:
            return _find(connection, name)

    def pending(self) -> list[Entry]:
        """What no robot has answered yet, in the order in which it was said."""
        query = select(corrections).where(corrections.c.status == Status.PENDING)
        return self._read(query.order_by(corrections.c.sequence))

    def page(
        self, robot: str | None, episode: str | None, limit: int, before: int | None
    ) -> list[Entry]:
        """Up to `limit` entries, the newest first, from before sequence number `before`."""
        query = select(corrections).order_by(corrections.c.sequence.desc()).limit(limit)
        if robot is not None:
            query = query.where(corrections.c.robot == robot)
        if episode is not None:
            query = query.where(corrections.c.episode == episode)
        if before is not None:
            query = query.where(corrections.c.sequence < before)
        return self._read(query)

    def _read(self, query: Select[Any]) -> list[Entry]:
        with self._readers.connect() as connection:
            return [_entry(row) for row in connection.execute(query)]

    def _post(self, connection: Connection, name: str, message: str, text: str) -> None:
        send(connection, f"{message}/{name}", self._outbox_key(message), text.encode())


def _values(correction: Correction, digest: str, status: Status) -> dict[str, Any]:
    return {
        "id": correction.id,
        "robot": correction.robot,
        "episode": correction.episode,
        "kind": correction.kind,
        "status": status,
        "digest": digest,
        "created_ns": correction.created_ns,
        "message": correction.model_dump_json(),
    }


def _find(connection: Connection, name: str) -> Entry | None:
    row = connection.execute(select(corrections).where(corrections.c.id == name)).one_or_none()
    return _entry(row) if row else None


def _close(
    connection: Connection, name: str, status: Status, reason: str, receipt: str | None
) -> Entry | None:
    change = (
        update(corrections)
        .where(corrections.c.id == name, corrections.c.status == Status.PENDING)
        .values(status=status, reason=reason, receipt=receipt)
        .returning(*corrections.c)
    )
    row = connection.execute(change).one_or_none()
    return _entry(row) if row else None


def _entry(row: Row[Any]) -> Entry:
    return Entry(
        sequence=row.sequence,
        correction=Correction.model_validate_json(row.message),
        status=Status(row.status),
        digest=row.digest,
        receipt=Receipt.model_validate_json(row.receipt) if row.receipt else None,
        reason=row.reason or "",
    )
