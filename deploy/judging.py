"""Evaluations beside the running loop: one after the other, each a process of its own."""

import json
import os
import queue
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

from shared.errors import HldError


class Judging:
    """A queue of high levels to be evaluated, and what was found.

    found: by name, the summaries that `hld evaluate` wrote. processes: of the next evaluation.
    """

    def __init__(
        self,
        folder: Path,
        site: str,
        tasks: tuple[str, ...],
        episodes: int,
        extra: tuple[str, ...] = (),
    ) -> None:
        """extra: further options of `hld evaluate`."""
        self._folder, self._site, self._tasks = folder, site, tasks
        self.episodes, self.processes, self._extra = episodes, 1, extra
        self._wanted: queue.Queue[tuple[str, str]] = queue.Queue()
        self._known: set[str] = set()
        self._process: subprocess.Popen[bytes] | None = None
        self._closed = False
        self.found: dict[str, dict[str, Any]] = {}
        self.failed = ""
        threading.Thread(target=self._work, daemon=True).start()

    def want(self, name: str, high_level: str) -> None:
        """Evaluate `high_level` under `name`; asking twice is fine.

        Raises:
            HldError: an earlier evaluation failed; the message holds the end of its log.
        """
        if self.failed:
            raise HldError(self.failed)
        if name not in self._known:
            self._known.add(name)
            self._wanted.put((name, high_level))

    def close(self) -> None:
        """Break off; what was rolled out is kept and need not be done again."""
        self._closed = True
        if self._process and self._process.poll() is None:
            self._process.terminate()
            self._process.wait()

    def _work(self) -> None:
        while not self._closed:
            name, high_level = self._wanted.get()
            self._judge(name, high_level)

    def _judge(self, name: str, high_level: str) -> None:
        self._folder.mkdir(parents=True, exist_ok=True)
        report, log = self._folder / f"{name}.json", self._folder / f"{name}.log"
        command = [
            *(sys.executable, "-m", "services.actor.judge", "--high-level", high_level),
            *("--site", self._site, "--task", ",".join(self._tasks)),
            *("--seeds", f"0:{self.episodes}", "--report", str(report)),
            *("--processes", str(self.processes)),
            *self._extra,
        ]
        with log.open("ab") as file:
            self._process = subprocess.Popen(
                command,
                stdout=file,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                env={**os.environ, "HLD_SUPERVISOR_PID": str(os.getpid())},
            )
            code = self._process.wait()
        if self._closed:
            return
        if code:
            tail = "\n".join(log.read_text(errors="replace").splitlines()[-8:])
            self.failed = f"the evaluation of {name} ended with code {code}:\n{tail}"
            return
        self.found[name] = json.loads(report.read_text())
