"""A learner process tells what it keeps while it trains, and does what was decided over HTTP."""

import json
import time
from pathlib import Path
from typing import Any

import httpx

from services.correction_api.archive import Archive
from shared.messages.heartbeat import LearnerState
from shared.messages.recording import RecordingQuery, StillQuery
from shared.wire.bus import Bus
from tests.integration.correction_api.running import running
from tests.integration.learner.lab import Lab
from tests.integration.learner.process import until
from tests.integration.learner.world import happenings

PATIENCE_S = 30.0  # As long as the API may wait.


def test_what_is_kept_is_told_while_a_round_trains(lab: Lab, bus: Bus) -> None:
    lab.start(round__corrections=3, train__steps=100_000, gate__held_out_share=0)
    lab.wait_for("1.0")
    for sent in happenings("e-1", lab.low_level_sha256):
        lab.deliver(sent)
    archive = Archive(bus, "lab", PATIENCE_S)
    until(lambda: lab.beats[-1].state is LearnerState.TRAINING and lab.beats[-1].progress > 0, "…")
    took_s = []
    for _ in range(20):
        begun = time.monotonic()
        lineage = archive.lineage()
        recording = archive.recording(RecordingQuery(episode="e-1"))
        still = archive.still(StillQuery(decision="e-1-40", camera="angle"))
        took_s.append(time.monotonic() - begun)
    assert [round_.state for round_ in lineage.rounds] == ["running"]
    assert [one.step for one in recording.decisions] == [0, 40, 80]
    assert still.arrays["jpeg"].tobytes()[:2] == b"\xff\xd8"
    assert lab.beats[-1].state is LearnerState.TRAINING
    print(json.dumps({"three answers, s": sorted(took_s)}))


def test_a_rollback_over_http_is_done_and_told(lab: Lab, bus: Bus, tmp_path: Path) -> None:
    lab.start(round__corrections=3, train__steps=2, gate__held_out_share=0)
    lab.wait_for("1.0")
    for sent in happenings("e-1", lab.low_level_sha256):
        lab.deliver(sent)
    lab.wait_for("1.1")
    with running(bus, tmp_path, archive_s=PATIENCE_S) as api:
        body = {"verb": "rollback", "version": 0, "author": "anna", "reason": "it drops the bread"}
        assert api.post("api/v1/policy/rulings", json=body).status_code == 201
        lab.wait_for("1.2")
        told = until(lambda: _done(api), "the ruling is told as done")
        assert (told["version"], told["versions"][-1]["again"]) == ("1.2", 0)
        (ruling,) = told["rulings"]
        assert (ruling["made"], ruling["ruling"]["reason"]) == (2, "it drops the bread")
        assert told["rounds"][0]["brought"].startswith("3 corrections: ")


def test_a_rollback_over_http_to_what_is_in_force_ends_the_trial_of_a_later_version(
    lab: Lab, bus: Bus, tmp_path: Path
) -> None:
    first = {"gate__canary__robots": '["robot-7"]', "gate__held_out_share": 0}
    lab.start(round__corrections=3, train__steps=2, **first)
    lab.wait_for("1.0")
    for sent in happenings("e-1", lab.low_level_sha256):
        lab.deliver(sent)
    with running(bus, tmp_path, archive_s=PATIENCE_S) as api:
        on_trial = until(lambda: _on_trial(api), "a version is on trial")
        assert (on_trial["version"], on_trial["versions"][-1]["robots"]) == ("1.0", ["robot-7"])
        body = {"verb": "rollback", "version": 0, "author": "anna", "reason": "it drops the bread"}
        answer = api.post("api/v1/policy/rulings", json=body)
        assert answer.status_code == 201, answer.text
        lab.wait_for("1.2")
        told = until(lambda: _done(api), "the ruling is told as done")
        assert (told["version"], told["versions"][-1]["again"]) == ("1.2", 0)
        assert [one["state"] for one in told["rounds"]] == ["failed"]
        again = api.post("api/v1/policy/rulings", json=body | {"version": 2})
        assert (again.status_code, "is in force" in again.json()["detail"]) == (409, True)


def _on_trial(api: httpx.Client) -> dict[str, Any] | None:
    told: dict[str, Any] = api.get("api/v1/policy").json()
    return told if any(one["robots"] for one in told.get("versions", [])) else None


def _done(api: httpx.Client) -> dict[str, object] | None:
    told = api.get("api/v1/policy").json()
    states = [ruling["state"] for ruling in told.get("rulings", [])]
    return told if states == ["done"] else None
