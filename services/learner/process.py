"""Train in a process beside the learner, so that nothing it does can hold up what arrives.

A process and not a thread: torch and Python share one lock in a thread, a process can be ended
at any moment, and one that runs out of memory takes no acknowledged record with it.
"""

import os
import subprocess
import sys
import threading
from contextlib import suppress
from pathlib import Path
from typing import IO, cast

import structlog
from pydantic import BaseModel, ConfigDict

from services.learner.gate import Candidate
from services.learner.store.store import Round
from shared.errors import PolicyError
from shared.policies.checkpoint import bundled, load_card

COMMAND = (sys.executable, "-m", "services.learner.train")
YIELDING = {"GOMP_SPINCOUNT": "1000"}
"""A thread of torch that waits for another soon sleeps. By default it spins on, and where robots
have the cores it does so while they keep the other one from working: see the README. GNU's name,
whose OpenMP torch has on Linux."""
ATTEMPTS = 3
"""Processes for one training. One that ends without a word ran out of memory or was killed, and the
next one goes on where it was."""


class Job(BaseModel):
    """What a training process is told, as one line of JSON on its standard input.

    store: URL of the store, which it only reads. tensors: the folder of the store's tensors.
    demonstrations: checkpoint folder; None takes the one that comes with the project.
    low_level: checkpoint folder of the low level that reads phrases; None: the project's own.
    under_way: file of what is trained so far; where it is there, the training goes on from it.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    store: str
    tensors: Path
    demonstrations: Path | None
    low_level: Path | None = None
    under_way: Path
    round: int


class Report(BaseModel):
    """What it answers, line by line: how far it is, and at the end what it made, or why not."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    progress: float = 0.0
    candidate: Candidate | None = None
    reason: str = ""


class TrainProcess:
    """A `Trainer` that starts `services.learner.train` for each round."""

    def __init__(
        self,
        store: str,
        tensors: Path,
        demonstrations: Path | None,
        low_level: Path | None = None,
    ) -> None:
        self._store, self._tensors, self._demonstrations = store, tensors, demonstrations
        self._low_level = low_level
        self._running: _Running | None = None
        self._attempts = 0
        self._log = structlog.get_logger()

    def demonstrations(self) -> str:
        """Hash of the demonstrations that a round would learn from; "" where it can't be told.

        Where there are none to be read, the training is what says so.
        """
        with suppress(PolicyError):
            return load_card(self._demonstrations or bundled("demonstrations")).tensors_sha256
        return ""

    def start(self, round_: Round) -> None:
        """Begin to train; returns at once."""
        job = Job(
            store=self._store,
            tensors=self._tensors,
            demonstrations=self._demonstrations,
            low_level=self._low_level,
            under_way=self._under_way(round_),
            round=round_.number,
        )
        self._running, self._attempts = _Running(job), 1

    def progress(self) -> float:
        """How far it is, 0 to 1."""
        return self._running.report.progress if self._running else 0.0

    def result(self) -> Candidate | None:
        """What came of it, once; None while it is at work.

        Raises:
            PolicyError: nothing came of it; the reason is in the text.
        """
        if self._running is None or self._running.process.poll() is None:
            return None
        ended, self._running = self._running, None
        code = ended.close()
        if ended.report.candidate is not None:
            return ended.report.candidate
        if ended.report.reason or self._attempts == ATTEMPTS:
            raise PolicyError(ended.report.reason or _explain(code))
        self._attempts += 1
        self._log.warning(
            "goes on in another process", reason=_explain(code), round=ended.job.round
        )
        self._running = _Running(ended.job)
        return None

    def forget(self, round_: Round) -> None:
        """Throw away what is kept of a training that is over."""
        self._under_way(round_).unlink(missing_ok=True)

    def _under_way(self, round_: Round) -> Path:
        return self._tensors.with_name(f"round-{round_.number}.under-way.safetensors")

    def stop(self) -> None:
        """Give up what is being trained, if anything is."""
        if self._running is not None:
            self._running.process.kill()
            self._running.close()
            self._running = None


class _Running:
    """A training process, and a thread that reads what it reports."""

    def __init__(self, job: Job) -> None:
        self.job, self.report = job, Report()
        self.process = subprocess.Popen(
            COMMAND,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={**YIELDING, **os.environ},
            start_new_session=True,  # Ctrl-C is for the learner; it ends its training itself.
        )
        # The line stays open after the job: its end tells the process that its learner died.
        stdin = cast(IO[str], self.process.stdin)
        stdin.write(job.model_dump_json() + "\n")
        stdin.flush()
        self._reader = threading.Thread(target=self._read, name="training", daemon=True)
        self._reader.start()

    def close(self) -> int:
        """Wait for its end, which is near; returns the exit code."""
        code = self.process.wait()
        self._reader.join()
        for pipe in (self.process.stdin, self.process.stdout):
            cast(IO[str], pipe).close()
        return code

    def _read(self) -> None:
        for line in cast(IO[str], self.process.stdout):
            self.report = Report.model_validate_json(line)


def _explain(code: int) -> str:
    if code < 0:
        return f"the training was ended by signal {-code}; the machine may be short of memory"
    return f"the training ended with exit code {code}; its log says more"
