"""What may not be lost waits here, on disk, until the other side says that it has it."""

import sqlite3
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple, Protocol

from shared.wire.closing import Closing

SCHEMA = """
CREATE TABLE IF NOT EXISTS parcels (
    sequence INTEGER PRIMARY KEY AUTOINCREMENT,
    id TEXT NOT NULL UNIQUE,
    key TEXT NOT NULL,
    payload BLOB NOT NULL
);
CREATE TABLE IF NOT EXISTS refused (
    sequence INTEGER PRIMARY KEY,
    id TEXT NOT NULL UNIQUE,
    key TEXT NOT NULL,
    payload BLOB NOT NULL,
    reason TEXT NOT NULL
);
"""


class Parcel(NamedTuple):
    """One record under way: asked at `key` with `payload`, told apart by `id`."""

    id: str
    key: str
    payload: bytes
    sequence: int


class Refusal(NamedTuple):
    """A parcel that the other side doesn't take, and why."""

    parcel: Parcel
    reason: str


class OutboxLike(Protocol):
    """What a `Courier` empties; a store with tables of its own can be one."""

    def pending(self, limit: int = 100) -> Sequence[Parcel]:
        """The parcels that wait, in the order in which they were added."""
        ...

    def done(self, id: str) -> None:
        """The other side has it: forget it."""
        ...

    def refuse(self, id: str, reason: str) -> None:
        """The other side doesn't take it: keep it aside, out of the way of the others."""
        ...

    def __len__(self) -> int:
        """How many wait."""
        ...


class Outbox(Closing):
    """An `OutboxLike` in a SQLite file of its own. Any thread may call; each change is on disk
    when the call returns (a flush: about a millisecond, up to 20 on a busy disk)."""

    def __init__(self, path: Path) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        self._lock = threading.Lock()
        self._store = sqlite3.connect(path, check_same_thread=False, timeout=10)
        self._store.execute("PRAGMA journal_mode=WAL")
        self._store.execute("PRAGMA synchronous=FULL")
        self._store.executescript(SCHEMA)

    def add(self, id: str, key: str, payload: bytes) -> None:
        """Keep a parcel; one that is here already stays as it is and where it is."""
        with self._lock, self._store:
            self._store.execute(
                "INSERT OR IGNORE INTO parcels (id, key, payload) SELECT ?, ?, ? "
                "WHERE NOT EXISTS (SELECT 1 FROM refused WHERE id = ?)",
                (id, key, payload, id),
            )

    def pending(self, limit: int = 100) -> list[Parcel]:
        with self._lock:
            rows = self._store.execute(
                "SELECT id, key, payload, sequence FROM parcels ORDER BY sequence LIMIT ?",
                (limit,),
            ).fetchall()
        return [Parcel(*row) for row in rows]

    def done(self, id: str) -> None:
        with self._lock, self._store:
            self._store.execute("DELETE FROM parcels WHERE id = ?", (id,))

    def refuse(self, id: str, reason: str) -> None:
        with self._lock, self._store:
            self._store.execute(
                "INSERT OR REPLACE INTO refused (sequence, id, key, payload, reason) "
                "SELECT sequence, id, key, payload, ? FROM parcels WHERE id = ?",
                (reason, id),
            )
            self._store.execute("DELETE FROM parcels WHERE id = ?", (id,))

    def refused(self) -> list[Refusal]:
        """The parcels that were kept aside, oldest first."""
        with self._lock:
            rows = self._store.execute(
                "SELECT id, key, payload, sequence, reason FROM refused ORDER BY sequence"
            ).fetchall()
        return [Refusal(Parcel(*row[:4]), row[4]) for row in rows]

    def retry(self) -> int:
        """Put what was kept aside back into its old place in the queue; how many that were."""
        with self._lock, self._store:
            self._store.execute(
                "INSERT OR IGNORE INTO parcels (sequence, id, key, payload) "
                "SELECT sequence, id, key, payload FROM refused"
            )
            return self._store.execute("DELETE FROM refused").rowcount

    def __len__(self) -> int:
        with self._lock:
            row = self._store.execute("SELECT COUNT(*) FROM parcels").fetchone()
        return int(row[0])

    def close(self) -> None:
        """Close the file; what waits is there when it is opened again."""
        with self._lock:
            self._store.close()
