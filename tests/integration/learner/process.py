"""Processes that a test starts and ends by their ids, and deadlines to wait until."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

DEADLINE_S = 150.0


class Process:
    """A `python -m …` that a test starts."""

    def __init__(self, module: str, *arguments: str, log: Path) -> None:
        with log.open("ab") as file:
            self._process = subprocess.Popen(
                [sys.executable, "-m", module, *arguments],
                stderr=file,
                stdout=file,
                env={**os.environ, "OMP_NUM_THREADS": "1"},
            )

    @property
    def running(self) -> bool:
        return self._process.poll() is None

    def children(self) -> set[int]:
        """The ids of the processes that it started."""
        tasks = Path(f"/proc/{self._process.pid}/task").glob("*/children")
        return {int(word) for task in tasks for word in task.read_text().split()}

    def kill(self) -> None:
        """As a power cut would."""
        self._process.kill()
        self._process.wait()

    def end(self) -> int:
        """As a person would; the exit code."""
        self._process.send_signal(signal.SIGTERM)
        return self._process.wait(DEADLINE_S)


def until(true: Callable[[], Any], what: str, seconds: float = DEADLINE_S) -> Any:
    """Wait until something holds; its value.

    Raises:
        AssertionError: it never did.
    """
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        found = true()
        if found:
            return found
        time.sleep(0.02)
    raise AssertionError(f"in {seconds} s it never came to this: {what}")


def lives(process_id: int) -> bool:
    """A process of this id runs; one that ended and nobody waited for doesn't."""
    try:
        return ") Z" not in Path(f"/proc/{process_id}/stat").read_text()
    except OSError:
        return False
