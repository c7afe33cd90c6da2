"""Runs the API in a thread on a free port, and waits for what a test expects of it."""

import asyncio
import queue
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

import httpx

from services.correction_api.build import opened
from services.correction_api.config import ApiSettings
from services.correction_api.loop import serve
from shared.service import Stop
from shared.wire.bus import Bus

WITHIN_S = 60.0  # Far more than is needed, for machines that are busy.

T = TypeVar("T")


@contextmanager
def running(bus: Bus, folder: Path, **settings: Any) -> Iterator[httpx.Client]:
    """A client of an API that serves while the context lasts."""
    watch = {"settle_s": 0.0} | settings.pop("watch", {})
    tree = {"port": 0, "database": folder / "api.sqlite", "watch": watch} | settings
    made = ApiSettings.model_validate(tree)
    stop, told = Stop(), queue.Queue[str]()
    thread = threading.Thread(
        target=lambda: asyncio.run(serve(made, partial(opened, made, bus), stop, told.put))
    )
    thread.start()
    try:
        with httpx.Client(base_url=told.get(timeout=WITHIN_S), timeout=WITHIN_S) as client:
            yield client
    finally:
        stop.set()
        thread.join()


def eventually(look: Callable[[], T], within_s: float = WITHIN_S) -> T:
    """What `look` returns, as soon as it is true.

    Raises:
        AssertionError: it never was, in time.
    """
    deadline = time.monotonic() + within_s
    while True:
        found = look()
        if found or time.monotonic() > deadline:
            assert found, "it did not happen in time"
            return found
        time.sleep(0.01)
