"""A correction's way from a client to the robot, the disk and the learner."""

import sqlite3
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import httpx
import pytest

from shared.messages.correction import Kind
from shared.messages.heartbeat import RobotState
from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.fakes import COMMANDS, FakeLearner, FakeRobot
from tests.integration.correction_api.running import eventually, running

ROBOT = "api/v1/robots/robot-1"
OVERRIDE = {"kind": "override", "text": "pick up the tomato", "author": "anna"}


def say(api: httpx.Client, body: dict[str, Any] | None = None, **headers: str) -> httpx.Response:
    return api.post(f"{ROBOT}/corrections", json=body or OVERRIDE, headers=headers)


def test_an_override_is_in_force_since_the_step_that_its_receipt_names(
    api: httpx.Client, robot: FakeRobot, learner: FakeLearner
) -> None:
    decision = robot.decide()
    eventually(lambda: api.get(ROBOT).json()["decision"])
    answer = say(api, {**OVERRIDE, "decision": decision.id})
    assert answer.status_code == 201
    said = answer.json()
    name = said["correction"]["id"]
    assert (said["status"], said["receipt"]["correction"]) == ("in force", name)
    assert said["receipt"]["step"] == robot.receipts[name].step
    assert said["correction"]["hold_steps"] is None
    assert said["correction"]["seen_step"] == decision.step
    shown = api.get(ROBOT).json()
    assert shown["command"]["text"] == "pick up the tomato"
    assert (shown["by"], shown["chosen_by"], shown["author"]) == ("person", name, "anna")
    assert api.get(f"api/v1/corrections/{name}").json() == said
    eventually(lambda: learner.taken == [("correction", name), ("receipt", name)])


def test_a_new_phrase_is_obeyed_and_its_neighbours_are_named(
    api: httpx.Client, learner: FakeLearner
) -> None:
    learner.announce()
    eventually(lambda: api.get("api/v1/learner").json().get("policy"))
    phrase = say(api, {**OVERRIDE, "text": "Pick up the chese"}).json()["phrase"]
    assert phrase == {"known": False, "nearest": phrase["nearest"]}
    assert phrase["nearest"][0] == "pick up the cheese"
    assert say(api, {**OVERRIDE, "text": COMMANDS[0]}).json()["phrase"]["known"]


@pytest.mark.parametrize("by_header", [True, False])
def test_the_same_thing_sent_again_is_said_once(
    api: httpx.Client, robot: FakeRobot, by_header: bool
) -> None:
    key = "0F3C/anything at all" if by_header else "say-mine"
    headers = {"Idempotency-Key": key} if by_header else {}
    body = OVERRIDE if by_header else {**OVERRIDE, "id": key}
    with ThreadPoolExecutor(8) as pool:
        answers = list(pool.map(lambda _: say(api, body, **headers), range(24)))
    # On a busy machine the robot's receipt may be late for the first ones: 202, and no receipt yet.
    assert {answer.status_code for answer in answers} <= {201, 202}
    eventually(lambda: say(api, body, **headers).status_code == 201)
    told = say(api, body, **headers).json()
    for answer in answers:
        same = ("correction", "receipt") if answer.status_code == 201 else ("correction",)
        assert all(answer.json()[part] == told[part] for part in same)
    assert len(robot.heard) == 1
    assert len(api.get("api/v1/corrections").json()["corrections"]) == 1


def test_an_id_that_was_used_for_something_else_is_refused(api: httpx.Client) -> None:
    assert say(api, {**OVERRIDE, "id": "say-1"}).status_code == 201
    other = say(api, {**OVERRIDE, "text": "wait", "id": "say-1"})
    assert other.status_code == 409
    assert "'say-1' named a different correction" in other.json()["detail"]
    twice = say(api, {**OVERRIDE, "id": "say-2"}, **{"Idempotency-Key": "say-3"})
    assert twice.status_code == 422


def test_a_correction_for_an_episode_that_is_over_names_the_current_one(
    api: httpx.Client, robot: FakeRobot
) -> None:
    old = robot.decide()
    eventually(lambda: api.get(ROBOT).json()["decision"])
    robot.end()
    eventually(lambda: api.get(ROBOT).json()["episode"] == "robot-1-e2")
    for body in ({"episode": old.episode}, {"decision": old.id}):
        answer = say(api, {**OVERRIDE, **body})
        assert answer.status_code == 409
        problem = answer.json()
        assert problem["type"].endswith(":episode-over")
        assert "robot-1-e1 of robot-1 is over; the current one is robot-1-e2" in problem["detail"]
        assert problem["current"]["episode"] == "robot-1-e2"
    assert robot.heard == []


def test_what_the_robot_refuses_is_kept_and_its_reason_is_told(
    api: httpx.Client, robot: FakeRobot, learner: FakeLearner
) -> None:
    robot.reason = "no override holds, so there is nothing to release"
    answer = say(api, {"kind": "release"})
    assert answer.status_code == 409
    problem = answer.json()
    assert problem["detail"] == robot.reason
    assert problem["current"]["episode"] == robot.episode
    kept = api.get(f"api/v1/corrections/{problem['correction']}").json()
    assert kept["status"] == "refused"
    eventually(lambda: learner.taken[-1:] == [("receipt", problem["correction"])])


def test_the_other_kinds_are_taken_to_the_robot(api: httpx.Client, robot: FakeRobot) -> None:
    decision = robot.decide()
    bodies: list[dict[str, Any]] = [
        {"kind": "approve", "decision": decision.id},
        {"kind": "pass", "decision": decision.id},
        OVERRIDE,
        {"kind": "release"},
        {"kind": "pause"},
        {"kind": "resume"},
    ]
    assert [say(api, body).status_code for body in bodies] == [201] * 6
    assert [heard.kind for heard in robot.heard] == [Kind(body["kind"]) for body in bodies]


@pytest.mark.parametrize(
    ("path", "body", "status", "detail"),
    [
        ("robot-l", OVERRIDE, 404, "no robot 'robot-l'; nearest known: 'robot-1'"),
        ("robot-1", {"kind": "override", "text": ""}, 422, "it was empty"),
        ("robot-1", {"kind": "override", "text": "a" * 201}, 422, "at most 200"),
        ("robot-1", {"kind": "override", "text": "a\x07b"}, 422, "U+0007 at character 1"),
        ("robot-1", {"kind": "override", "txt": "wait"}, 422, "nearest known: 'text'"),
        ("robot-1", {"kind": "overide", "text": "wait"}, 422, "'override', 'release'"),
        ("robot-1", {}, 422, "kind is missing"),
        ("robot-1", {**OVERRIDE, "author": "Ada Lovelace"}, 422, "author: use lower-case letters"),
        (
            "robot-1",
            {**OVERRIDE, "hold_steps": "5"},
            422,
            "hold_steps: Input should be a valid int",
        ),
        ("robot-1", {**OVERRIDE, "hold_steps": True}, 422, "integer, not True"),
        ("robot-1", {**OVERRIDE, "episode": "ep-gone"}, 409, "ep-gone of robot-1 is unknown"),
        ("robot-1", {**OVERRIDE, "decision": "ep-gone-1"}, 409, "is robot-1-e1"),
        ("robot-1", {"kind": "approve", "decision": "x"}, 404, "no decision 'x' of robot-1"),
        ("robot-1", [], 422, "body"),
    ],
)
def test_a_mistake_is_told_with_what_would_be_right(
    standing_api: httpx.Client, path: str, body: Any, status: int, detail: str
) -> None:
    answer = standing_api.post(f"api/v1/robots/{path}/corrections", json=body)
    assert answer.status_code == status
    assert answer.headers["Content-Type"] == "application/problem+json"
    problem = answer.json()
    assert detail in problem["detail"]
    assert (problem["status"], problem["instance"]) == (status, answer.url.path)


def test_an_error_shows_only_the_beginning_of_what_is_very_long(
    standing_api: httpx.Client,
) -> None:
    name = "r" * 3000
    answers = [
        standing_api.post(f"api/v1/robots/{name}/corrections", json=OVERRIDE),
        standing_api.get(f"api/v1/corrections/{name}"),
        standing_api.post(f"{ROBOT}/corrections", json={**OVERRIDE, name: 1}),
    ]
    assert [answer.status_code for answer in answers] == [404, 404, 422]
    assert all("rrr" in answer.json()["detail"] for answer in answers)
    assert all(len(answer.content) < 1000 for answer in answers)


def test_a_decision_from_before_a_restart_is_not_obeyed_in_the_next_episode(
    router: MemoryRouter, robot: FakeRobot, tmp_path: Path
) -> None:
    old = robot.decide()
    robot.end()
    with MemoryBus(router) as bus, running(bus, tmp_path) as api:
        eventually(lambda: api.get("api/v1/robots").json()["robots"])
        answer = say(api, {**OVERRIDE, "decision": old.id})
        assert answer.status_code == 409
        assert "the current one is robot-1-e2" in answer.json()["detail"]
    assert robot.heard == []


@pytest.mark.parametrize(
    ("content", "media_type", "status"),
    [
        (b"{", "application/json", 400),
        (b"\xff\xfe", "application/json", 400),
        (b"[" * 50_000, "application/json", 400),
        (b'{"kind": "pause"}', "text/plain", 415),
        (b'{"kind": "pause", "kind": "resume"}', "application/x-www-form-urlencoded", 415),
        (b'"' + b"a" * 70_000 + b'"', "application/json", 413),
    ],
)
def test_what_is_no_json_is_a_problem_and_no_crash(
    standing_api: httpx.Client, content: bytes, media_type: str, status: int
) -> None:
    headers = {"Content-Type": media_type}
    for body in (content, iter([content])):  # With its length told, and in chunks.
        answer = standing_api.post(f"{ROBOT}/corrections", content=body, headers=headers)
        assert answer.status_code == status
        assert answer.headers["Content-Type"] == "application/problem+json"


def test_a_robot_that_is_away_gets_it_when_it_is_back(
    router: MemoryRouter, learner: FakeLearner, tmp_path: Path
) -> None:
    with MemoryBus(router) as bus, MemoryBus(router) as robots:
        robot = FakeRobot(robots)
        with running(bus, tmp_path, watch={"stale_s": 0.2, "offline_s": 0.4}) as api:
            eventually(lambda: api.get("api/v1/robots").json()["robots"])
            robot.close()
            eventually(lambda: api.get(ROBOT).json()["presence"] == "offline")
            answer = say(api)
            assert (answer.status_code, answer.json()["status"]) == (202, "pending")
            name = answer.json()["correction"]["id"]
            back = FakeRobot(robots)
            path = f"api/v1/corrections/{name}"
            eventually(lambda: api.get(path).json()["status"] == "in force")
            assert [heard.id for heard in back.heard] == [name]
            assert say(api, {**OVERRIDE, "id": name}).json()["correction"]["id"] == name
            back.close()
    assert learner.taken == [("correction", name), ("receipt", name)]


def test_what_nobody_answers_expires_and_is_told_as_such(
    api: httpx.Client, router: MemoryRouter, tmp_path: Path
) -> None:
    delivery = {"expire_s": 2.0, "answer_s": 0.1, "retry_max_s": 0.1}
    with MemoryBus(router) as bus, MemoryBus(router) as robots:
        with running(bus, tmp_path / "other", delivery=delivery) as other:
            mute = FakeRobot(robots, "robot-2")
            mute._serving[0].close()
            eventually(lambda: len(other.get("api/v1/robots").json()["robots"]) == 2)
            path = "api/v1/robots/robot-2/corrections"
            body = {**OVERRIDE, "id": "say-9"}
            assert other.post(path, json=body).status_code == 202
            found = "api/v1/corrections/say-9"
            eventually(lambda: other.get(found).json()["status"] == "expired")
            again = other.post(path, json=body)
            assert again.status_code == 409
            assert again.json()["detail"] == "the robot gave no receipt within 2 s"
            mute.close()
    del api  # It only has to be there: a second one does not disturb it.


def test_between_two_episodes_nothing_can_be_corrected_but_stopped(
    api: httpx.Client, robot: FakeRobot
) -> None:
    robot.end()
    robot.deaf = True
    robot.state = RobotState.IDLE
    late = {"kind": "override", "text": "wait", "episode": "robot-1-e1"}
    eventually(lambda: say(api, late).status_code == 409)
    assert "robot-1-e1 of robot-1 is over" in say(api, late).json()["detail"]
    assert say(api, {"kind": "pause", "episode": "robot-1-e1"}).json()["status"] == "in force"


def test_what_was_pending_is_taken_up_after_a_restart(router: MemoryRouter, tmp_path: Path) -> None:
    quick = {"answer_s": 0.05, "ask_s": 0.1}
    with MemoryBus(router) as bus, MemoryBus(router) as robots:
        robot = FakeRobot(robots)
        robot._serving[0].close()
        with running(bus, tmp_path, delivery=quick) as api:
            eventually(lambda: api.get("api/v1/robots").json()["robots"])
            names = [say(api).json()["correction"]["id"] for _ in range(3)]
        robot.close()
    with MemoryBus(router) as bus, MemoryBus(router) as others:
        robot, learner = FakeRobot(others), FakeLearner(others)
        with running(bus, tmp_path) as api:
            eventually(lambda: len(learner.taken) == 6)
            assert [heard.id for heard in robot.heard] == names
            shown = api.get("api/v1/corrections").json()["corrections"]
            assert [view["correction"]["id"] for view in shown] == names[::-1]
            assert {view["status"] for view in shown} == {"in force"}
        robot.close()
        learner.close()
    for name in names:
        assert [kind for kind, one in learner.taken if one == name] == ["correction", "receipt"]


def test_a_disk_that_takes_nothing_is_a_503_and_loses_nothing(
    api: httpx.Client, robot: FakeRobot, tmp_path: Path
) -> None:
    with sqlite3.connect(tmp_path / "api.sqlite", isolation_level=None) as other:
        other.execute("BEGIN IMMEDIATE")
        answer = say(api, {**OVERRIDE, "id": "say-1"})
        assert answer.status_code == 503
        assert answer.headers["Retry-After"] == "5"
        assert answer.json()["type"].endswith(":storage")
        assert robot.heard == []
        other.execute("ROLLBACK")
    other.close()
    assert say(api, {**OVERRIDE, "id": "say-1"}).status_code == 201


def test_a_learner_that_is_away_gets_everything_in_order_later(
    router: MemoryRouter, robot: FakeRobot, tmp_path: Path
) -> None:
    with MemoryBus(router) as bus, MemoryBus(router) as learners, running(bus, tmp_path) as api:
        eventually(lambda: api.get("api/v1/robots").json()["robots"])
        names = [say(api).json()["correction"]["id"] for _ in range(5)]
        assert api.get("api/v1/learner").json()["outbox"] == 10
        learner = FakeLearner(learners)
        eventually(lambda: api.get("api/v1/learner").json()["outbox"] == 0)
        expected = [(kind, name) for name in names for kind in ("correction", "receipt")]
        assert learner.taken == expected
        learner.close()
    assert len(robot.heard) == 5


def test_two_people_at_once_are_both_heard_in_the_order_of_the_log(
    api: httpx.Client, robot: FakeRobot
) -> None:
    threads = [threading.Thread(target=say, args=(api,)) for _ in range(16)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    shown = api.get("api/v1/corrections").json()["corrections"]
    assert [heard.id for heard in robot.heard] == [view["correction"]["id"] for view in shown][::-1]


def test_a_service_may_want_shorter_words(
    router: MemoryRouter, robot: FakeRobot, tmp_path: Path
) -> None:
    with MemoryBus(router) as bus, running(bus, tmp_path, text_characters=10) as api:
        eventually(lambda: api.get("api/v1/robots").json()["robots"])
        answer = say(api)
        assert answer.status_code == 422
        assert answer.json()["detail"] == "text: 18 characters are too many; at most 10"
        assert say(api, {**OVERRIDE, "text": "wait"}).status_code == 201
    assert len(robot.heard) == 1
