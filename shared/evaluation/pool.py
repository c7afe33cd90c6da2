"""All cores: processes that keep what they have loaded, and end with the one that started them."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import connection
from typing import Any, Protocol, Self, TypeVar

from shared.config import Settings
from shared.errors import HldError

J = TypeVar("J", contravariant=True)
R = TypeVar("R", covariant=True)
P = TypeVar("P", bound=Settings)
Job = TypeVar("Job")
Result = TypeVar("Result")


class Worker(Protocol[J, R]):
    """Does one job after another with what it has loaded."""

    def __call__(self, job: J, /) -> R: ...

    def close(self) -> None:
        """Give everything back."""
        ...


class Pool:
    """Processes for one command, shared by everything that it measures.

    They are spawned, since a GL context doesn't outlive a fork. They don't hear Ctrl-C: the
    process that has the pool does, and takes them with it.
    """

    def __init__(self, processes: int = 0) -> None:
        """processes: how many; 0: one a core."""
        self._pool = ProcessPoolExecutor(
            processes or os.cpu_count() or 1,
            mp_context=multiprocessing.get_context("spawn"),
            initializer=begin_worker,
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        broken_off = error[0] is not None
        self._pool.shutdown(wait=not broken_off, cancel_futures=True)
        if broken_off:  # What is at work takes long, and would be thrown away.
            for child in multiprocessing.active_children():
                child.terminate()

    def work(
        self, make: Callable[[P], Worker[Job, Result]], plan: P, jobs: Sequence[Job]
    ) -> Iterator[Result]:
        """Results as they are finished. make: what each process does once with the plan.

        Raises:
            HldError: a process died; and whatever a job raises.
        """
        try:
            futures = [self._pool.submit(_work, make, plan, job) for job in jobs]
            for future in as_completed(futures):
                yield future.result()
        except BrokenProcessPool:
            raise HldError(
                "a process was ended from outside, perhaps for want of memory; the same command "
                "goes on, --processes 1 needs the least"
            ) from None


_loaded: dict[str, Worker[Any, Any]] = {}  # At most one a process, by its plan.


def begin_worker() -> None:
    """Begins a spawned process: it doesn't hear Ctrl-C, and ends when its parent does."""
    os.environ.setdefault("LP_NUM_THREADS", "1")  # To draw: the processes share the cores.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        connection.wait([parent.sentinel])
        os._exit(1)


def _work(make: Callable[[P], Worker[Job, Result]], plan: P, job: Job) -> Result:
    key = f"{make.__qualname__} {plan.model_dump_json()}"
    if key not in _loaded:
        for old in _loaded.values():
            old.close()
        _loaded.clear()
        _loaded[key] = make(plan)
    result: Result = _loaded[key](job)
    return result
