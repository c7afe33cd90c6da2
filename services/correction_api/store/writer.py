"""The only thread that writes: whatever has gathered while it was busy shares the next commit.

Many writers on one SQLite file wait for one another badly; one writer with group commit does
not (an order of magnitude at the 99th percentile), and a future is set only after the flush.
"""

import queue
import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any, Generic, TypeVar

from sqlalchemy import Connection, Engine
from sqlalchemy.exc import SQLAlchemyError

from shared.errors import HldError

CAPACITY = 4096
GROUP = 256

T = TypeVar("T")


class StoreError(HldError):
    """The disk did not take it: full, busy or broken. Nothing was stored; try again later."""


class Job(Generic[T]):
    """A piece of work inside a transaction, and the future of its result."""

    def __init__(self, work: Callable[[Connection], T]) -> None:
        self.work = work
        self.future: Future[T] = Future()


class Writer:
    """Runs jobs in order, many to a transaction; close it before its engine."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self._jobs: queue.Queue[Job[Any] | None] = queue.Queue(CAPACITY)
        self._closed = False
        self._thread = threading.Thread(target=self._run, name="writer", daemon=True)
        self._thread.start()

    def submit(self, work: Callable[[Connection], T]) -> Future[T]:
        """Queue `work`; its future is set after the commit. Called from any thread.

        The future may raise `StoreError`, and whatever `work` raises.

        Raises:
            StoreError: the queue is full, or the writer was closed.
        """
        job = Job(work)
        if self._closed:
            raise StoreError("the log is closed")
        try:
            self._jobs.put_nowait(job)
        except queue.Full:
            raise StoreError(f"{CAPACITY} writes are waiting for the disk already") from None
        return job.future

    def close(self) -> None:
        """Write what is queued, then end the thread."""
        if not self._closed:
            self._closed = True
            self._jobs.put(None)
            self._thread.join()

    def _run(self) -> None:
        while (first := self._jobs.get()) is not None:
            group, last = self._gather(first)
            self._commit([job for job in group if job.future.set_running_or_notify_cancel()])
            if last:
                return

    def _gather(self, first: Job[Any]) -> tuple[list[Job[Any]], bool]:
        group = [first]
        while len(group) < GROUP:
            try:
                job = self._jobs.get_nowait()
            except queue.Empty:
                return group, False
            if job is None:
                return group, True
            group.append(job)
        return group, False

    def _commit(self, group: list[Job[Any]]) -> None:
        try:
            with self._engine.begin() as connection:
                results = [job.work(connection) for job in group]
        except Exception as error:  # Whatever it is, it belongs to whoever waits for the job.
            self._fail(group, error)
        else:
            for job, result in zip(group, results, strict=True):
                job.future.set_result(result)

    def _fail(self, group: list[Job[Any]], error: Exception) -> None:
        """One job must not spoil the others: a group that failed is run again one by one."""
        if len(group) > 1:
            for job in group:
                self._commit([job])
        elif group:
            known = StoreError(f"the disk did not take it: {_reason(error)}")
            group[0].future.set_exception(known if isinstance(error, SQLAlchemyError) else error)


def _reason(error: Exception) -> str:
    return str(getattr(error, "orig", None) or error)
