"""The one thread that writes to the store: what waits together is committed together."""

import queue
import threading
from collections.abc import Callable
from typing import Any, Generic, TypeVar, cast

import structlog
from sqlalchemy import Connection, Engine
from sqlalchemy.exc import OperationalError

T = TypeVar("T")

BATCH = 64
RETRY_S = 0.2


class StoreClosedError(Exception):
    """The store was closed before it could write.

    No HldError: on the bus that would be a refusal, at which a sender gives up. As any other
    error it is asked again, of the learner that comes next.
    """


class _Job(Generic[T]):
    """Work that somebody waits for; it may be run again when a commit did not succeed."""

    def __init__(self, work: Callable[[Connection], T]) -> None:
        self.work = work
        self.done = threading.Event()
        self.result: T | None = None
        self.error: Exception | None = None

    def run(self, connection: Connection) -> None:
        self.result = self.error = None
        try:
            with connection.begin_nested():
                self.result = self.work(connection)
        except OperationalError:
            raise
        except Exception as error:
            self.error = error  # Told to who waits; the others of the batch go on.


class Writer:
    """Runs pieces of work one after another and returns each when it is on the disk.

    One writer, because SQLite lets only one write at a time, and those that wait for its lock
    wait long; a batch, because a commit costs a flush of the disk however little it holds.

    While the disk is full or the file is locked, callers wait and it tries again: an answer
    "refused" would make a sender give up what could have been kept a minute later.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self._jobs: queue.Queue[_Job[Any] | None] = queue.Queue()
        self._closed = threading.Event()
        self._log = structlog.get_logger()
        self._thread = threading.Thread(target=self._run, name="store-writer", daemon=True)
        self._thread.start()

    def do(self, work: Callable[[Connection], T]) -> T:
        """Run `work` in a transaction; blocks until it is committed.

        Raises:
            StoreClosedError: the writer was closed before it came to that.
            Exception: whatever `work` raised; then nothing of it was written.
        """
        if self._closed.is_set():
            raise StoreClosedError("the store is closed")
        job = _Job(work)
        self._jobs.put(job)
        while not job.done.wait(1.0):
            if not self._thread.is_alive():
                raise StoreClosedError("the store was closed before it could write")
        if job.error is not None:
            raise job.error
        return cast(T, job.result)

    def close(self) -> None:
        """Write what waits, then end."""
        self._closed.set()
        self._jobs.put(None)
        self._thread.join()

    def _run(self) -> None:
        while (batch := self._next_batch()) is not None:
            if batch and self._commit(batch):
                for job in batch:
                    job.done.set()

    def _next_batch(self) -> list[_Job[Any]] | None:
        """What waits, at least one job; None at the end."""
        first = self._jobs.get()
        if first is None:
            return None
        batch = [first]
        while len(batch) < BATCH:
            try:
                job = self._jobs.get_nowait()
            except queue.Empty:
                break
            if job is None:
                self._jobs.put(None)  # Write this batch first.
                break
            batch.append(job)
        return batch

    def _commit(self, batch: list[_Job[Any]]) -> bool:
        while True:
            try:
                with self._engine.begin() as connection:
                    for job in batch:
                        job.run(connection)
                return True
            except OperationalError as error:
                self._log.error("the store cannot write, trying again", reason=str(error.orig))
                if self._closed.wait(RETRY_S):
                    return False
            except Exception as error:
                for job in batch:
                    job.error = error
                return True
