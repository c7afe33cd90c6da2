"""The processes of a laptop: started in order, restarted when they die, ended in reverse."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

from shared.errors import HldError

GRACE_S = 15.0
BACKOFF_S = (0.5, 1.0, 2.0, 5.0, 10.0)
STEADY_S = 20.0  # Who ran that long before dying begins the backoff anew.
PATIENCE = 6  # Quick deaths in a row after which nobody believes in a next try.


class ChildError(HldError):
    """A process could not be kept running; the message shows the end of its log."""


class Child:
    """One process: `python -m MODULE …`, its log in a file."""

    def __init__(self, name: str, module: str, arguments: Sequence[str], log: Path) -> None:
        self.name, self.log = name, log
        self._command = [sys.executable, "-m", module, *arguments]
        self._process: subprocess.Popen[bytes] | None = None
        self._deaths = 0
        self._born = 0.0
        self._restart_at = 0.0
        self._told = 0  # The log up to there is of earlier runs.
        self.restarts = 0

    @property
    def pid(self) -> int | None:
        """The process id while it runs."""
        return self._process.pid if self._process and self.running else None

    @property
    def running(self) -> bool:
        return self._process is not None and self._process.poll() is None

    def start(self, environment: Mapping[str, str] = os.environ) -> None:
        """Begin, in a session of its own, so that Ctrl-C reaches only who supervises."""
        self._born = time.monotonic()
        self._told = self.log.stat().st_size if self.log.exists() else 0
        supervised = {**environment, "HLD_SUPERVISOR_PID": str(os.getpid())}
        with self.log.open("ab") as log:
            self._process = subprocess.Popen(
                self._command,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                env=supervised,
            )

    def mind(self) -> None:
        """Start it again when it has died, later each time.

        Raises:
            ChildError: it ended with exit code 2, a wrong configuration that no restart can mend,
                or it died `PATIENCE` times in a row soon after it was started.
        """
        if self.running:
            return
        now = time.monotonic()
        code = self._process.returncode if self._process else None
        if code == 2:
            said = [line for line in self.tail().splitlines() if not line.startswith("{")]
            raise ChildError(f"{self.name} cannot start:\n" + "\n".join(said))
        if not self._restart_at:
            self._deaths = 1 if now - self._born > STEADY_S else self._deaths + 1
            if self._deaths >= PATIENCE:
                raise ChildError(f"{self.name} died {PATIENCE} times in a row:\n{self.tail()}")
            self._restart_at = now + BACKOFF_S[min(self._deaths, len(BACKOFF_S)) - 1]
        elif now >= self._restart_at:
            self._restart_at = 0.0
            self.restarts += 1
            self.start()

    def ask_to_end(self) -> None:
        """SIGTERM; see `wait`."""
        if self.running and self._process:
            self._process.send_signal(signal.SIGTERM)

    def wait(self, timeout_s: float = GRACE_S) -> bool:
        """Until it has ended; killed, and False, when it takes too long."""
        if self._process is None:
            return True
        try:
            self._process.wait(timeout_s)
            return True
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
            return False

    def tail(self, lines: int = 12) -> str:
        """The end of what it has logged since it was last started."""
        told = self.log.read_bytes()[self._told :].decode(errors="replace")
        return "\n".join(line[:400] for line in told.splitlines()[-lines:])


class Family:
    """All children together."""

    def __init__(self, logs: Path) -> None:
        self._logs = logs
        self.children: list[Child] = []
        logs.mkdir(parents=True, exist_ok=True)

    def add(self, name: str, module: str, *arguments: str) -> Child:
        """Start one more."""
        child = Child(name, module, arguments, self._logs / f"{name}.log")
        child.start()
        self.children.append(child)
        return child

    def mind(self) -> None:
        """Look after each of them."""
        for child in self.children:
            child.mind()

    def retire(self, *prefixes: str) -> None:
        """End those whose name begins so, for good: their work is done."""
        retired = [child for child in self.children if child.name.startswith(prefixes)]
        for child in reversed(retired):
            child.ask_to_end()
            child.wait()
            self.children.remove(child)

    def end(self) -> list[str]:
        """End them, the last one first; the names of those that had to be killed."""
        killed = []
        for child in reversed(self.children):
            child.ask_to_end()
            if not child.wait():
                killed.append(child.name)
        return killed


def sets(**values: object) -> list[str]:
    """`--set` arguments; a double underscore in a name stands for a dot."""
    arguments: list[str] = []
    for name, value in values.items():
        arguments += ["--set", f"{name.replace('__', '.')}={json.dumps(value)}"]
    return arguments
