"""Afterwards over HTTP: real API, real store and teller of a learner, on a bus in the process."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from services.learner.store.sql import SqlStore
from shared.messages.episode import Outcome
from shared.messages.policy import Version
from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.fakes import COMMANDS, FakeRobot
from tests.integration.correction_api.keeper import attempt, keeping
from tests.integration.correction_api.running import eventually, running

SAID = "api/v1/robots/robot-1/corrections"


@pytest.fixture
def store(router: MemoryRouter, tmp_path: Path) -> Iterator[SqlStore]:
    """What a learner keeps; it answers while the test runs."""
    with keeping(router, tmp_path) as store:
        yield store


@pytest.fixture
def served(
    router: MemoryRouter, robot: FakeRobot, store: SqlStore, tmp_path: Path
) -> Iterator[httpx.Client]:
    """An API beside that learner, which has heard of robot-1."""
    del robot, store  # They only have to be there.
    with MemoryBus(router) as bus, running(bus, tmp_path) as client:
        eventually(lambda: client.get("api/v1/robots").json()["robots"])
        yield client


def listed(api: httpx.Client, **query: Any) -> list[str]:
    answer = api.get("api/v1/episodes", params=query)
    assert answer.status_code == 200, answer.text
    return [episode["id"] for episode in answer.json()["episodes"]]


def test_episodes_are_found_by_what_they_were_like(served: httpx.Client, robot: FakeRobot) -> None:
    good = attempt(served, robot)
    robot.ask(doubt=0.7)
    eventually(lambda: served.get("api/v1/help").json()["asking"])
    bad = attempt(served, robot, Outcome.TIMEOUT)
    assert listed(served) == [bad.id, good.id]
    assert listed(served, success="true") == [good.id]
    assert listed(served, success="false", task="sandwich", version="1.0") == [bad.id]
    assert listed(served, task="pack") == []
    assert listed(served, doubt="true") == [bad.id]
    assert listed(served, doubt="false") == [good.id]
    assert served.get("api/v1/episodes").json()["tasks"] == ["sandwich"]
    (call,) = served.get(f"api/v1/episodes/{bad.id}").json()["calls"]
    assert (call["reason"], call["doubt"]) == ("entropy", 0.7)
    first = served.get("api/v1/episodes?limit=1").json()
    assert listed(served, limit=1, cursor=first["next"]) == [good.id]
    wrong = served.get("api/v1/episodes?sucess=true")
    assert wrong.status_code == 422
    assert "nearest known: 'success'" in wrong.json()["detail"]


def test_an_episode_is_told_with_its_decisions_and_what_was_said(
    served: httpx.Client, robot: FakeRobot
) -> None:
    over = attempt(served, robot, decisions=5)
    said = {"kind": "relabel", "episode": over.id, "text": "wait", "first_step": 0, "end_step": 30}
    assert served.post(SAID, json={**said, "author": "anna"}).json()["status"] == "kept"
    account = served.get(f"api/v1/episodes/{over.id}").json()
    assert account["episode"]["taught"] == 1
    assert [view["correction"]["kind"] for view in account["corrections"]] == ["relabel"]
    assert listed(served, corrected="true") == [over.id]
    path = f"api/v1/episodes/{over.id}/decisions"
    part = served.get(path, params={"limit": 2}).json()
    assert part["next"] == 2
    rest = served.get(path, params={"first": part["next"]}).json()
    told = [*part["decisions"], *rest["decisions"]]
    assert [one["index"] for one in told] == [0, 1, 2, 3, 4]
    assert rest["next"] is None
    assert told[0]["proposed"][0]["goal"]["text"] == COMMANDS[0]
    assert "truth" not in told[0]


def test_a_still_is_a_jpeg_and_mistakes_are_told(served: httpx.Client, robot: FakeRobot) -> None:
    over = attempt(served, robot)
    path = f"api/v1/episodes/{over.id}/stills/{over.id}-0"
    picture = served.get(f"{path}/angle")
    assert (picture.status_code, picture.headers["Content-Type"]) == (200, "image/jpeg")
    assert picture.content[:2] == b"\xff\xd8"
    assert "immutable" in picture.headers["Cache-Control"]
    for wrong, status, detail in (
        (f"{path}/angel", 404, "nearest known: 'angle'"),
        (f"api/v1/episodes/{over.id}/stills/{over.id}-9/top", 404, "no decision"),
        (f"api/v1/episodes/{over.id}/stills/other-0/top", 404, f"{over.id}-NUMBER"),
        ("api/v1/episodes/robot-1-e9", 404, "nearest known: 'robot-1-e1'"),
    ):
        answer = served.get(wrong)
        assert (answer.status_code, detail in answer.json()["detail"]) == (status, True), wrong


def test_a_learner_that_is_away_is_told_and_what_is_known_here_is_shown(
    api: httpx.Client, robot: FakeRobot
) -> None:
    robot.decide()
    over = robot.end()
    eventually(lambda: listed(api) == [over.id])
    for path in (
        "policy",
        f"episodes/{over.id}/decisions",
        f"episodes/{over.id}/stills/{over.id}-0/top",
    ):
        answer = api.get(f"api/v1/{path}")
        assert answer.status_code == 503
        assert answer.headers["Content-Type"] == "application/problem+json"
        assert "no learner answers" in answer.json()["detail"]
        assert answer.headers["Retry-After"]
    assert api.get(f"api/v1/episodes/{over.id}").status_code == 200
    (version,) = api.get("api/v1/progress").json()["versions"]
    assert (version["version"], version["service"]["n"]) == ("1.0", 1)
    assert api.get("api/v1/reports/transitions").json()["figures"]["oracle"]["slow"]


def test_a_version_is_the_same_one_after_another_learner_took_over_its_store(
    api: httpx.Client, robot: FakeRobot
) -> None:
    ended = []
    for version, outcome in (((1, 1), "success"), ((1, 2), "timeout"), ((2, 1), "timeout")):
        robot.version = Version(*version)
        ended.append(robot.end(Outcome(outcome)).id)
    eventually(lambda: listed(api) == ended[::-1])
    told = api.get("api/v1/progress").json()["versions"]
    assert [(one["version"], one["also"], one["service"]["n"]) for one in told] == [
        ("1.1", ["2.1"], 2),
        ("1.2", [], 1),
    ]
    assert [one["service"]["share"] for one in told] == [0.5, 0]


def test_what_a_round_brought_is_told_in_words(served: httpx.Client) -> None:
    told = served.get("api/v1/policy").json()
    assert told["version"] == "1.1"
    assert [round_["brought"] for round_ in told["rounds"]] == [
        "14 corrections: 52 % → 71 %, n = 200 in the gate's paired episodes",
        "3 corrections: agreement with held-out labels 80 % → 60 %, n = 40; "
        "held back, since it agrees with .600",
    ]
    assert [round_["promotable"] for round_ in told["rounds"]] == [False, True]
    assert [(one["version"], one["round"], one["in_force"]) for one in told["versions"]] == [
        ("1.0", None, False),
        ("1.1", 1, True),
    ]


def test_a_ruling_needs_a_reason_and_reaches_the_learner(
    served: httpx.Client, store: SqlStore
) -> None:
    path = "api/v1/policy/rulings"
    back = {"verb": "rollback", "version": 0, "author": "anna", "id": "rule-a"}
    for body, status, detail in (
        (back, 422, "reason is missing"),
        (back | {"reason": " "}, 422, "it was empty"),
        ({"verb": "promote", "author": "anna", "reason": "x"}, 422, "promote needs round"),
        (back | {"version": 1, "reason": "x"}, 409, "version 1.1 is in force; possible: 0"),
        (back | {"version": 7, "reason": "x"}, 409, "no version 7; possible: 0"),
        (
            {"verb": "promote", "round": 1, "author": "anna", "reason": "x"},
            409,
            "round 1 passed the gate, and its version went out: roll back to that; possible: 2",
        ),
    ):
        answer = served.post(path, json=body)
        assert (answer.status_code, detail in answer.json()["detail"]) == (status, True), (
            answer.text
        )
    body = back | {"reason": "it drops the bread"}
    kept = served.post(path, json=body)
    assert (kept.status_code, kept.json()["state"]) == (201, "waiting")
    assert served.post(path, json=body).json()["ruling"] == kept.json()["ruling"]
    assert served.post(path, json=body | {"reason": "another"}).status_code == 409
    (answer,) = eventually(store.answers)
    assert (answer.ruling.id, answer.ruling.reason) == ("rule-a", "it drops the bread")
    (shown,) = eventually(
        lambda: [
            one for one in served.get("api/v1/policy").json()["rulings"] if one["state"] == "given"
        ]
    )
    assert shown["ruling"]["author"] == "anna"


def test_a_ruling_is_kept_for_a_learner_that_is_away(api: httpx.Client) -> None:
    body = {"verb": "promote", "round": 2, "author": "anna", "reason": "a bad scene"}
    answer = api.post("api/v1/policy/rulings", json=body)
    assert (answer.status_code, answer.json()["state"]) == (202, "waiting")
    assert api.get("api/v1/learner").json()["outbox"] == 1
