"""A training process that ends without a word: another one goes on, but not for ever."""

import sys
import time
from pathlib import Path

import pytest

from services.learner import process
from services.learner.process import ATTEMPTS, TrainProcess
from services.learner.store.store import Manifest, Round
from shared.errors import PolicyError

ASKED = """
import os, sys
sys.stdin.readline()
print('{"reason": "threads that wait spin %s times"}' % os.environ["GOMP_SPINCOUNT"], flush=True)
"""
KILLED = """
import os, pathlib, signal, sys
sys.stdin.readline()
tally = pathlib.Path({tally!r})
tally.write_text(tally.read_text() + "x" if tally.exists() else "x")
if len(tally.read_text()) <= {times}:
    os.kill(os.getpid(), signal.SIGKILL)
print('{{"reason": "nothing to learn from"}}', flush=True)
"""
ROUND = Round(number=1, epoch=1, parent=0, seed=1, manifest=Manifest(), begun_ns=1)


def told(folder: Path, times: int, monkeypatch: pytest.MonkeyPatch) -> str:
    """What a trainer says in the end whose process is killed so many times."""
    return ended(folder, KILLED.format(tally=str(folder / "tally"), times=times), monkeypatch)


def ended(folder: Path, program: str, monkeypatch: pytest.MonkeyPatch) -> str:
    """The reason for which a trainer that runs this program makes nothing."""
    monkeypatch.setattr(process, "COMMAND", (sys.executable, "-c", program))
    trainer = TrainProcess("sqlite://", folder / "tensors", None)
    trainer.start(ROUND)
    while True:
        try:
            assert trainer.result() is None
        except PolicyError as error:
            return str(error)
        time.sleep(0.01)


def test_a_training_that_was_killed_goes_on_in_another_process(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert told(tmp_path, 1, monkeypatch) == "nothing to learn from"
    assert (tmp_path / "tally").read_text() == "xx"


def test_one_that_is_killed_each_time_ends_with_the_reason(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert "ended by signal 9; the machine may be short of memory" in told(
        tmp_path, ATTEMPTS, monkeypatch
    )
    assert (tmp_path / "tally").read_text() == "x" * ATTEMPTS


def test_threads_of_a_training_that_wait_for_one_another_leave_the_cores_to_robots(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("GOMP_SPINCOUNT", raising=False)
    assert ended(tmp_path, ASKED, monkeypatch) == "threads that wait spin 1000 times"
    monkeypatch.setenv("GOMP_SPINCOUNT", "7")  # Who knows better is asked first.
    assert ended(tmp_path, ASKED, monkeypatch) == "threads that wait spin 7 times"
