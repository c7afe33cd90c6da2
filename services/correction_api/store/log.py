"""The log of what people said: appended once, closed once by a receipt, never rewritten."""

from collections.abc import Callable, Sequence
from concurrent.futures import Future
from enum import StrEnum
from typing import Any, NamedTuple

from sqlalchemy import Connection, Engine, Row, Select, insert, select, update

from services.correction_api.store.endings import ended_by, find_endings
from services.correction_api.store.parcels import send
from services.correction_api.store.tables import corrections, learned
from services.correction_api.store.writer import Writer
from shared.messages.correction import AFTERWARDS, Correction
from shared.messages.policy import Version
from shared.messages.receipt import Receipt


class Status(StrEnum):
    """What became of a correction: `expired` means that no robot ever answered; `kept`, that none
    had to, since it is about the past."""

    PENDING = "pending"
    IN_FORCE = "in force"
    REFUSED = "refused"
    EXPIRED = "expired"
    KEPT = "kept"


class Later(NamedTuple):
    """A correction that ended an earlier one, and the control step since which it did."""

    correction: Correction
    step: int


class Entry(NamedTuple):
    """One correction as the log has it.

    digest: of what the client sent. reason: why it was refused, or why it expired.
    later: it took force, and this one ended it.
    learned_in: the first version that was trained with it; held_out: it is kept aside to judge
        versions by. Both as the learner told.
    """

    sequence: int
    correction: Correction
    status: Status
    digest: str
    receipt: Receipt | None
    reason: str
    learned_in: Version | None = None
    held_out: bool = False
    later: Later | None = None


class Closed(NamedTuple):
    """A correction that was closed, and the earlier one that it ended, if it did."""

    entry: Entry
    replaced: Entry | None = None


class Log:
    """Corrections on disk; writes go through the writer thread, reads through a pool."""

    def __init__(self, writer: Writer, readers: Engine, outbox_key: Callable[[str], str]) -> None:
        """outbox_key: at which key the learner takes a "correction" or a "receipt"."""
        self._writer, self._readers, self._outbox_key = writer, readers, outbox_key

    def append(
        self,
        correction: Correction,
        digest: str,
        status: Status = Status.PENDING,
        reason: str = "",
    ) -> Future[Entry]:
        """Keep a correction, and post it to the learner; the entry that is there wins.

        status: pending, or kept where no robot has to hear it. reason: what isn't known of it.
        """

        def work(connection: Connection) -> Entry:
            if found := find_entry(connection, correction.id):
                return found
            values = _values(correction, digest, status) | {"reason": reason}
            key = insert(corrections).values(values).returning(corrections.c.sequence)
            sequence = connection.execute(key).scalar_one()
            self._post(connection, correction.id, "correction", correction.model_dump_json())
            return Entry(sequence, correction, status, digest, None, reason)

        return self._writer.submit(work)

    def answer(self, receipt: Receipt) -> Future[Closed | None]:
        """Close a correction by its receipt, and post that to the learner.

        The result is None when it was closed before, or was never opened.
        """

        def work(connection: Connection) -> Closed | None:
            status = Status.IN_FORCE if receipt.accepted else Status.REFUSED
            text = receipt.model_dump_json()
            entry = _close(connection, receipt.correction, status, receipt.reason, text)
            if entry is None:
                return None
            self._post(connection, receipt.correction, "receipt", text)
            ended = ended_by(entry.correction, receipt)
            return Closed(entry, find_entry(connection, ended) if ended else None)

        return self._writer.submit(work)

    def expire(self, correction: Correction, reason: str) -> Future[Closed | None]:
        """Close a correction that no robot answered; one about the past stays true all the same."""
        status = Status.KEPT if correction.kind in AFTERWARDS else Status.EXPIRED

        def work(connection: Connection) -> Closed | None:
            entry = _close(connection, correction.id, status, reason, None)
            return Closed(entry) if entry else None

        return self._writer.submit(work)

    def probe(self) -> None:
        """See whether the disk takes anything.

        Raises:
            StoreError: it doesn't.
        """
        self._writer.submit(bool).result()  # A transaction in which nothing is done.

    def find(self, name: str) -> Entry | None:
        """The entry of the correction with this id."""
        with self._readers.connect() as connection:
            return find_entry(connection, name)

    def pending(self) -> list[Entry]:
        """What no robot has answered yet, in the order in which it was said."""
        query = _ENTRIES.where(corrections.c.status == Status.PENDING)
        return self._read(query.order_by(corrections.c.sequence))

    def page(
        self, robot: str | None, episode: str | None, limit: int, before: int | None
    ) -> list[Entry]:
        """Up to `limit` entries, the newest first, from before sequence number `before`."""
        query = _ENTRIES.order_by(corrections.c.sequence.desc()).limit(limit)
        if robot is not None:
            query = query.where(corrections.c.robot == robot)
        if episode is not None:
            query = query.where(corrections.c.episode == episode)
        if before is not None:
            query = query.where(corrections.c.sequence < before)
        return self._read(query)

    def _read(self, query: Select[Any]) -> list[Entry]:
        with self._readers.connect() as connection:
            rows = connection.execute(query).all()
            return _entries(connection, rows)

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


_ENTRIES = select(
    corrections, learned.c.correction.label("told"), learned.c.version.label("learned_in")
).outerjoin(learned, learned.c.correction == corrections.c.id)


def find_entry(connection: Connection, name: str) -> Entry | None:
    """The entry of a correction, within somebody else's transaction."""
    rows = connection.execute(_ENTRIES.where(corrections.c.id == name)).all()
    return next(iter(_entries(connection, rows)), None)


def _close(
    connection: Connection, name: str, status: Status, reason: str, receipt: str | None
) -> Entry | None:
    change = (
        update(corrections)
        .where(corrections.c.id == name, corrections.c.status == Status.PENDING)
        .values(status=status, reason=reason, receipt=receipt)
    )
    return find_entry(connection, name) if connection.execute(change).rowcount else None


def _entries(connection: Connection, rows: Sequence[Row[Any]]) -> list[Entry]:
    """The rows as entries, each with what ended it."""
    later = {name: _later(row) for name, row in find_endings(connection, rows).items()}
    return [_entry(row)._replace(later=later.get(row.id)) for row in rows]


def _later(row: Row[Any]) -> Later:
    receipt = Receipt.model_validate_json(row.receipt)
    assert receipt.step is not None  # Only an accepted one ends anything.
    return Later(Correction.model_validate_json(row.message), receipt.step)


def _entry(row: Row[Any]) -> Entry:
    return Entry(
        sequence=row.sequence,
        correction=Correction.model_validate_json(row.message),
        status=Status(row.status),
        digest=row.digest,
        receipt=Receipt.model_validate_json(row.receipt) if row.receipt else None,
        reason=row.reason or "",
        learned_in=Version.parse(row.learned_in) if row.learned_in else None,
        held_out=row.told is not None and row.learned_in is None,
    )
