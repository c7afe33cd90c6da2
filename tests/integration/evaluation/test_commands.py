"""The commands that measure, as a user starts them: real policies, real processes, killed too."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest
import typer
from typer.testing import CliRunner

from services.actor import judge, say
from services.learner.experiments import __main__ as experiments

DEADLINE_S = 250.0


def hld(*arguments):
    return [sys.executable, "-m", "deploy.hld", *map(str, arguments)]


def run(*arguments):
    return subprocess.run(hld(*arguments), capture_output=True, text=True, timeout=DEADLINE_S)


def rows(report):
    file = report.with_suffix(".rows.jsonl")
    return file.read_text().splitlines(keepends=True) if file.exists() else []


def evaluation(report, seeds):
    named = ("--high-level", "oracle", "--site", "lab", "--seeds", seeds, "--processes", 1)
    return ("evaluate", *named, "--report", report)


def test_an_evaluation_that_was_killed_goes_on_where_it_was(tmp_path):
    report = tmp_path / "r.json"
    killed = subprocess.Popen(
        hld(*evaluation(report, "0:40")), stdout=subprocess.DEVNULL, start_new_session=True
    )
    deadline = time.monotonic() + DEADLINE_S
    while len(rows(report)) < 2:
        assert time.monotonic() < deadline
        assert killed.poll() is None
        time.sleep(0.01)
    killed.kill()
    killed.wait()
    _gone(killed.pid)
    kept = [row for row in rows(report) if row.endswith("\n")]
    again = run(*evaluation(report, "0:3"))
    assert again.returncode == 0, again.stderr
    assert rows(report)[: len(kept)] == kept
    content = json.loads(report.read_text())
    assert content["n"] == 3
    assert set(content["tasks"]) <= {"sandwich", "pack", "bus"}
    assert content["skills"]["pick up"]["n"] >= 6
    assert content["command"].startswith("hld evaluate --high-level oracle")
    assert "pick up" in again.stdout


def test_an_evaluation_that_is_told_to_end_does_so_with_its_processes(tmp_path):
    report = tmp_path / "r.json"
    running = subprocess.Popen(
        hld(*evaluation(report, "0:40")), stdout=subprocess.DEVNULL, start_new_session=True
    )
    deadline = time.monotonic() + DEADLINE_S
    while not rows(report):
        assert time.monotonic() < deadline
        time.sleep(0.01)
    running.send_signal(signal.SIGTERM)
    assert running.wait(DEADLINE_S) == 130
    _gone(running.pid)
    assert not report.exists()


def _gone(group):
    """Nobody of it stays behind."""
    deadline = time.monotonic() + DEADLINE_S
    while alive(group):
        assert time.monotonic() < deadline
        time.sleep(0.01)


def alive(group):
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


def test_a_phrase_is_said_and_reported(tmp_path):
    report = tmp_path / "said.json"
    done = run("say", "grab the cheese", "--task", "sandwich", "--seed", 2, "--report", report)
    assert done.returncode == 0, done.stderr
    content = json.loads(report.read_text())
    assert content["phrase"] == "grab the cheese"
    assert content["nearest"][0]["command"] == "pick up the cheese"
    assert content["achieved"] == "pick up the cheese"
    assert content["refused"] is False
    assert 0 < content["steps"] <= 240


def test_what_was_so_before_is_told_as_such(tmp_path):
    report = tmp_path / "new" / "said.json"
    done = run("say", "pick up the ham", "--holding", "ham", "--steps", 40, "--report", report)
    assert done.returncode == 0, done.stderr
    assert "nothing, it was so before" in done.stdout
    content = json.loads(report.read_text())
    assert (content["already"], content["achieved"]) == (True, None)


def test_an_experiment_writes_its_report_for_machines_and_for_people(tmp_path):
    done = run("experiment", "skills", "--out", tmp_path, "--scale", "small", "--n", 1)
    assert done.returncode == 0, done.stderr
    assert "19 of 19" in done.stdout  # Nobody looks at a terminal: lines tell how far it is.
    content = json.loads((tmp_path / "report.json").read_text())
    assert content["experiment"] == "skills"
    assert all(found["n"] == 1 for found in content["figures"]["skills"].values())
    assert "pick up the cheese" in (tmp_path / "report.md").read_text()
    assert (tmp_path / content["pictures"][0]).exists()


@pytest.mark.parametrize(
    ("command", "arguments", "words"),
    [
        (judge.main, ("--seeds", "5:2"), "0:60"),
        (judge.main, ("--high-level", "9.9"), "base, oracle"),
        (judge.main, ("--task", "dance"), "sandwich"),
        (judge.main, ("--set", "latency=3"), "latency_steps"),
        (judge.main, ("--set", "looks=9"), "set looks to 4 or less"),
        (judge.main, ("--set", "history=5"), "set history to 4 or less"),
        (judge.main, ("--task", "pack, dance"), "task 'dance'"),
        (judge.main, ("--report", "/dev/null/r.json"), "cannot write into"),
        (say.main, ("wait", "--report", "/dev/null/r.json"), "cannot write into"),
        (experiments.main, ("skills", "--out", "/dev/null/x"), "cannot write into"),
        (experiments.main, ("skills", "--out", "x", "--n", "3", "--seeds", "0:9"), "--seeds 0:3"),
        (say.main, (" ",), "pick up the cheese"),
        (say.main, ("put it down", "--holding", "hamm"), "ham"),
        (say.main, ("put it down", "--seed", "140000000"), "0 to 139999999"),
        (say.main, ("put it down", "--seed", "-1"), "0 to 139999999"),
        (experiments.main, ("skill", "--out", "x"), "skills"),
        (experiments.main, ("skills", "--out", "x", "--scale", "huge"), "full"),
        (experiments.main, ("skills", "--out", "x", "--scale", "core"), "'full', 'small'"),
        (experiments.main, ("skills", "--out", "x", "--high-level", "base"), "horizon"),
        (experiments.main, ("baselines", "--out", "x", "--low-level", "y"), "skills"),
        (experiments.main, ("skills", "--out", "x", "--n", "0"), "or equal to 1"),
        (experiments.main, ("horizon", "--out", "x", "--baselines", "y"), "only for dagger"),
        (experiments.main, ("dagger", "--out", "x", "--baselines", "y"), "fits-*/flat-*"),
    ],
)
def test_bad_input_is_an_error_that_says_what_would_be_right(command, arguments, words):
    app = typer.Typer()
    app.command()(command)
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 2
    assert words in done.stderr
