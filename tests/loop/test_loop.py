"""The main job, as a user starts it: robots work, the oracle corrects, the high level gets better.

Separate processes, real Zenoh, real HTTP, real SQLite, real MuJoCo; figures come from the report
that `hld up` writes. The number of episodes is what the difference needs to show, see the README.
"""

import json
import os
import subprocess
import sys

import pytest

from deploy.ports import free_port
from shared.policies.checkpoint import bundled
from shared.policies.low_level import LowLevel

EPISODES, EVALUATE, GATE = 24, 24, 8


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("loop")
    report = folder / "report.json"
    command = [
        *(sys.executable, "-m", "deploy.hld", "up", "--oracle", "--rounds", "2"),
        *("--episodes", str(EPISODES), "--evaluate", str(EVALUATE), "--report", str(report)),
        *("--data", str(folder / "up"), "--seed", "7"),
        *("--gate", str(GATE), "--port", str(free_port()), "--router-port", str(free_port())),
    ]
    environment = {**os.environ, "PYTHONWARNINGS": "default"}
    done = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=3000)
    print(done.stdout[-4000:], done.stderr[-2000:])
    assert done.returncode == 0
    return done.stdout, json.loads(report.read_text()), folder


@pytest.mark.timeout(3100)
def test_after_the_rounds_the_robots_do_better_than_chance_could_explain(run):
    _, report, _ = run
    base, last = report["versions"][0], report["versions"][-1]
    print(json.dumps(report, indent=2))
    assert base["n"] == last["n"] == EVALUATE
    assert last["interval"][0] > base["interval"][1]


def test_every_round_made_a_version_from_more_corrections_than_the_one_before(run):
    _, report, _ = run
    versions = report["versions"]
    assert [row["version"] for row in versions] == ["1.0", "1.1", "1.2"]
    assert [row["episodes"] for row in versions] == [0, EPISODES, 2 * EPISODES]
    corrections = [row["corrections"] for row in versions]
    assert corrections[0] == 0 < corrections[1] < corrections[2]


def test_every_version_was_tried_in_pairs_by_an_actor_before_it_went_out(run):
    _, _, folder = run
    found = folder / "policy.json"
    data = ("--data", str(folder / "up"), "--report", str(found))
    subprocess.run([sys.executable, "-m", "deploy.hld", "policy", "list", *data], check=True)
    for round_ in json.loads(found.read_text())["rounds"]:
        trials = round_["figures"]["trials"]
        assert trials["candidate"]["n"] == trials["in_force"]["n"] == GATE
        assert trials["difference"] >= -0.05 or trials["p"] > 0.2


def test_the_low_level_did_not_change(run):
    _, report, _ = run
    hashes = report["low_level_sha256"]
    assert hashes["before"] == LowLevel.load(bundled("low_level")).sha256
    assert hashes["before"] == hashes["after"]


def test_there_is_room_between_the_base_and_the_oracle_with_the_same_low_level(run):
    _, report, _ = run
    oracle = report["oracle"]
    assert oracle["n"] == EVALUATE
    assert oracle["interval"][0] > report["versions"][0]["interval"][1]
    assert report["complete"]


def test_a_plot_for_people_lies_beside_the_report(run):
    out, _, folder = run
    assert "<svg" in (folder / "report.svg").read_text()
    assert "everything is kept in" in out
