"""Real processes for tests of the wire, and waiting for them until a deadline."""

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Self

from shared.errors import NoAnswerError
from shared.wire.bus import Bus, BusSettings, open_bus

ROOT = Path(__file__).parents[3]


def until(holds: Callable[[], object], timeout_s: float = 10.0, what: str = "") -> None:
    """Look again and again until it holds; fail when the time is out."""
    deadline = time.monotonic() + timeout_s
    while not holds():
        assert time.monotonic() < deadline, f"not within {timeout_s} s: {what or holds}"
        time.sleep(0.005)


def answered(bus: Bus, key: str = "a") -> bool:
    """Whether somebody answers `ok` now."""
    try:
        return bus.ask(key, timeout_s=1) == b"ok"
    except NoAnswerError:
        return False


def free_port() -> int:
    """A port of the loopback that nobody listens on."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


class Child:
    """A Python module as a process of its own; ended when the block is left."""

    def __init__(self, module: str, *arguments: str) -> None:
        self._command = [sys.executable, "-m", module, *arguments]
        self._process: subprocess.Popen[str] | None = None

    def start(self) -> Self:
        environment = {k: v for k, v in os.environ.items() if not k.startswith("HLD_")}
        self._process = subprocess.Popen(
            self._command,
            cwd=ROOT,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        return self

    def signal(self, number: signal.Signals) -> None:
        """SIGSTOP: it stands still when this returns."""
        assert self._process
        self._process.send_signal(number)
        if number == signal.SIGSTOP:
            os.waitid(os.P_PID, self._process.pid, os.WSTOPPED | os.WNOWAIT)

    def kill(self) -> None:
        """As a power cut: no time for anything."""
        self.signal(signal.SIGKILL)
        self.ended()

    def ended(self, timeout_s: float = 10.0) -> tuple[int, str, str]:
        """Wait for its end: exit code, standard output, standard error."""
        assert self._process
        out, err = self._process.communicate(timeout=timeout_s)
        return self._process.returncode, out, err

    def __enter__(self) -> Self:
        return self.start()

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._process and self._process.returncode is None:
            self.signal(signal.SIGCONT)
            self.kill()


class RouterProcess(Child):
    """`python -m deploy.router` on a free port."""

    def __init__(self, *arguments: str) -> None:
        self.port = free_port()
        super().__init__("deploy.router", "--set", f"port={self.port}", *arguments)

    @property
    def settings(self) -> BusSettings:
        """For a bus through this router."""
        return BusSettings(connect=(f"tcp/127.0.0.1:{self.port}",))

    def bus(self) -> Bus:
        """A bus that has found this router."""
        bus = open_bus(self.settings)
        assert bus.joined(20), "the router did not come up"
        return bus
