"""What can be read: robots, decisions as they come, history, episodes, health."""

import socket
import threading
from contextlib import ExitStack
from pathlib import Path

import httpx
import pytest

from shared.messages.episode import Outcome
from shared.wire.bus import Bus
from shared.wire.keys import robot_key
from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.fakes import FLEET, FakeLearner, FakeRobot
from tests.integration.correction_api.running import eventually, running

DECISION = "api/v1/robots/robot-1/decision"


def test_a_decision_is_told_as_soon_as_it_is_there(api: httpx.Client, robot: FakeRobot) -> None:
    first = robot.decide(truth={"held": "cheese"})
    told = api.get(DECISION).json()
    assert told["id"] == first.id
    assert told["truth"] == {"held": "cheese"}
    assert told["proposed"][0]["goal"]["text"] == "pick up the cheese"
    timer = threading.Timer(0.2, robot.decide)
    timer.start()
    # Its end would come long after the client had given up.
    told = api.get(DECISION, params={"after": first.id, "wait_s": 60}).json()
    assert told["index"] == 1
    timer.join()


def test_waiting_for_a_decision_ends(api: httpx.Client, robot: FakeRobot) -> None:
    decision = robot.decide()
    eventually(lambda: api.get(DECISION, params={"wait_s": 0}).status_code == 200)
    answer = api.get(DECISION, params={"after": decision.id, "wait_s": 0.1})
    assert (answer.status_code, answer.content) == (204, b"")


@pytest.mark.parametrize("wait_s", ["-1", "61", "nan", "inf", "soon"])
def test_a_wait_has_its_limits(standing_api: httpx.Client, wait_s: str) -> None:
    assert standing_api.get(DECISION, params={"wait_s": wait_s}).status_code == 422


def test_who_waits_for_a_decision_does_not_hold_up_the_end(
    router: MemoryRouter, robot: FakeRobot, tmp_path: Path
) -> None:
    with MemoryBus(router) as bus, ExitStack() as stack:
        with running(bus, tmp_path) as api:
            eventually(lambda: api.get("api/v1/robots").json()["robots"])
            newest = robot.decide().id
            eventually(lambda: api.get(DECISION).json()["id"] == newest)
            place = (api.base_url.host, api.base_url.port)
            waiting = stack.enter_context(socket.create_connection(place, timeout=30))
            question = f"GET /{DECISION}?after={newest}&wait_s=60 HTTP/1.1"
            waiting.sendall(f"{question}\r\nHost: {place[0]}:{place[1]}\r\n\r\n".encode())
            # Who comes by another connection is answered after it was read.
            assert httpx.get(api.base_url.join("healthz")).status_code == 200
        assert waiting.recv(100).startswith(b"HTTP/1.1 204")


def test_history_is_read_page_by_page(api: httpx.Client) -> None:
    path = "api/v1/robots/robot-1/corrections"
    names = [api.post(path, json={"kind": "pause"}).json()["correction"]["id"] for _ in range(5)]
    read: list[str] = []
    query: dict[str, str] | None = {"robot": "robot-1", "limit": "2"}
    while query:
        page = api.get("api/v1/corrections", params=query).json()
        read += [view["correction"]["id"] for view in page["corrections"]]
        query = query | {"cursor": page["next"]} if page["next"] else None
    assert read == names[::-1]
    assert api.get("api/v1/corrections", params={"robot": "robot-2"}).json()["corrections"] == []
    assert api.get("api/v1/corrections", params={"robt": "robot-1"}).status_code == 422
    unknown = api.get(f"api/v1/corrections/{names[0][:-1]}")
    assert unknown.status_code == 404
    assert names[0] in unknown.json()["detail"]


def test_success_is_counted_by_version_without_what_was_broken_off(
    api: httpx.Client, robot: FakeRobot
) -> None:
    for outcome in (Outcome.SUCCESS, Outcome.TIMEOUT, Outcome.ABORTED, Outcome.SUCCESS):
        robot.end(outcome)
    eventually(lambda: len(api.get("api/v1/episodes").json()["episodes"]) == 4)
    page = api.get("api/v1/episodes", params={"limit": 3}).json()
    assert [episode["number"] for episode in page["episodes"]] == [4, 3, 2]
    assert page["tally"] == [{"version": "1.0", "episodes": 3, "successes": 2, "corrections": 6}]
    rest = api.get("api/v1/episodes", params={"cursor": page["next"]}).json()
    assert [episode["number"] for episode in rest["episodes"]] == [1]


def test_the_learner_is_shown_when_there_is_one(api: httpx.Client, learner: FakeLearner) -> None:
    assert api.get("api/v1/learner").json() == {"presence": "unseen", "outbox": 0}
    learner.announce("1.3")
    learner.beat()
    eventually(lambda: api.get("api/v1/learner").json()["presence"] == "online")
    shown = api.get("api/v1/learner").json()
    assert (shown["state"], shown["version"], shown["corrections"]) == ("collecting", "1.0", 3)
    learner.announce("1.2")
    assert eventually(lambda: api.get("api/v1/learner").json()["policy"])["version"] == "1.3"


def test_health_tells_what_is_missing(api: httpx.Client, router: MemoryRouter) -> None:
    for prefix in ("", "api/v1/"):
        assert api.get(f"{prefix}healthz").json() == {"status": "alive"}
        assert api.get(f"{prefix}readyz").json() == {"status": "ready"}
        assert "hldagger_robots 1.0" in api.get(f"{prefix}metrics").text
    router.stop()
    down = api.get("readyz")
    assert down.status_code == 503
    assert "no router answers at tcp/127.0.0.1:7447" in down.json()["detail"]
    assert api.get("healthz").status_code == 200


def test_messages_that_are_none_are_counted_and_harm_nobody(
    api: httpx.Client, router: MemoryRouter, robot: FakeRobot
) -> None:
    bus: Bus
    with MemoryBus(router) as bus:
        for message in ("heartbeat", "decision", "episode"):
            bus.put(robot_key(FLEET, "robot-1", message), b"\x80no message")
        heartbeats: list[bytes] = []
        with_heartbeats = bus.subscribe(
            robot_key(FLEET, "robot-1", "heartbeat"), lambda _, payload: heartbeats.append(payload)
        )
        eventually(lambda: heartbeats)
        bus.put(robot_key(FLEET, "robot-9", "heartbeat"), heartbeats[0])  # For another robot.
        with_heartbeats.close()
    eventually(lambda: "hldagger_messages_unreadable_total 4.0" in api.get("metrics").text)
    assert [entry["robot"] for entry in api.get("api/v1/robots").json()["robots"]] == [robot.name]


def test_below_a_path_prefix_everything_is_where_it_belongs(
    router: MemoryRouter, robot: FakeRobot, tmp_path: Path
) -> None:
    with MemoryBus(router) as bus, running(bus, tmp_path, prefix="/cell/7") as api:
        assert str(api.base_url).endswith("/cell/7/")
        eventually(lambda: api.get("api/v1/robots").json()["robots"])
        assert "main.js" in api.get("").text
        assert api.get("main.js").status_code == 200
        assert api.get("api/v1/openapi.json").json()["servers"] == [{"url": "/cell/7"}]
        stripped = httpx.get(api.base_url.copy_with(path="/api/v1/robots/robot-1"))
        assert stripped.json()["robot"] == robot.name


def test_history_can_be_read_before_its_robots_are_heard_of_again(
    router: MemoryRouter, tmp_path: Path
) -> None:
    with MemoryBus(router) as bus, MemoryBus(router) as robots:
        robot = FakeRobot(robots)
        with running(bus, tmp_path) as api:
            eventually(lambda: api.get("api/v1/robots").json()["robots"])
            body = {"kind": "override", "text": "wait"}
            said = api.post("api/v1/robots/robot-1/corrections", json=body).json()
        robot.close()
        with running(bus, tmp_path) as api:
            shown = api.get("api/v1/corrections").json()["corrections"]
            assert shown == [said | {"phrase": None}]
            assert api.get("api/v1/robots/robot-1").status_code == 404
