"""The WebSocket: states and pictures for pages, and no page can slow anything down."""

import json
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import httpx
import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import ClientConnection, connect

from shared.wire.keys import robot_key
from shared.wire.memory import MemoryRouter
from tests.integration.correction_api.fakes import FLEET, FakeLearner, FakeRobot
from tests.integration.correction_api.running import WITHIN_S, eventually

WATCH = json.dumps({"watch": [{"robot": "robot-1", "camera": "angle"}]})
FRAME_KEY = robot_key(FLEET, "robot-1", "frame-angle")


def address(api: httpx.Client) -> str:
    return str(api.base_url.join("api/v1/live").copy_with(scheme="ws"))


@contextmanager
def page(api: httpx.Client, **options: Any) -> Iterator[ClientConnection]:
    # A client that stops reading never reads the answer to its closing either: don't wait for it.
    with connect(address(api), proxy=None, close_timeout=0.2, **options) as connection:
        yield connection


def read(connection: ClientConnection, kind: str) -> dict[str, Any]:
    """The next message of a kind."""
    deadline = time.monotonic() + WITHIN_S
    while time.monotonic() < deadline:
        message = connection.recv(timeout=WITHIN_S)
        if isinstance(message, bytes):
            size = int.from_bytes(message[:2], "big")
            told = json.loads(message[2 : 2 + size]) | {"jpeg": message[2 + size :]}
        else:
            told = json.loads(message)
        if told["type"] == kind:
            return dict(told)
    raise AssertionError(f"no {kind} came")


def test_a_page_is_told_of_everything(
    api: httpx.Client, robot: FakeRobot, learner: FakeLearner
) -> None:
    with page(api) as connection:
        assert read(connection, "robot")["robot"]["robot"] == "robot-1"
        learner.beat()
        while "state" not in (told := read(connection, "learner")["learner"]):
            continue  # The greeting: no learner was heard of yet.
        assert told["state"] == "collecting"
        decision = robot.decide(truth={"secret": "x"})
        told = read(connection, "decision")["decision"]
        assert told["id"] == decision.id
        assert "truth" not in told
        said = {"kind": "override", "text": "wait", "author": "anna"}
        api.post("api/v1/robots/robot-1/corrections", json=said)
        view = read(connection, "correction")["correction"]
        if view["status"] == "pending":
            view = read(connection, "correction")["correction"]
        assert (view["status"], view["correction"]["author"]) == ("in force", "anna")
        robot.end()
        assert read(connection, "episode")["episode"] == {"robot": "robot-1"}


def test_pictures_are_asked_for_only_while_somebody_looks(
    api: httpx.Client, router: MemoryRouter
) -> None:
    assert not router.watched(FRAME_KEY)
    with page(api) as connection:
        connection.send(WATCH)
        frame = read(connection, "frame")
        assert (frame["robot"], frame["camera"]) == ("robot-1", "angle")
        assert frame["jpeg"][:2] == b"\xff\xd8"
        assert router.watched(FRAME_KEY)
        connection.send('{"watch": []}')
        eventually(lambda: not router.watched(FRAME_KEY))
        connection.send(WATCH)
        eventually(lambda: router.watched(FRAME_KEY))
    eventually(lambda: not router.watched(FRAME_KEY))


def test_a_page_that_does_not_read_slows_nobody_down(api: httpx.Client, robot: FakeRobot) -> None:
    with socket.socket() as slow, page(api) as quick:
        slow.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        slow.connect(("127.0.0.1", api.base_url.port))
        with connect(address(api), sock=slow, proxy=None, max_queue=1, close_timeout=0) as mute:
            mute.send(WATCH)
            quick.send(WATCH)
            read(quick, "frame")
            for _ in range(60):  # 20 MB, far more than the sockets' buffers hold.
                robot.step += 1
                robot.show("angle", (480, 640))
            last = robot.step
            while read(quick, "frame")["step"] < last:
                continue
            # Nobody waits: for a receipt that doesn't come in time the answer would be "pending".
            assert [_paused(api) for _ in range(20)] == ["in force"] * 20
            slow.close()
    assert 'hldagger_live_dropped_total{kind="frame"}' in api.get("metrics").text


def _paused(api: httpx.Client) -> str:
    answer = api.post("api/v1/robots/robot-1/corrections", json={"kind": "pause"})
    return str(answer.json()["status"])


@pytest.mark.parametrize(
    "text", ["", "[]", '{"watch": 1}', '{"watch": [{"robot": "a/**", "camera": "top"}]}']
)
def test_a_page_that_talks_nonsense_is_told_so(standing_api: httpx.Client, text: str) -> None:
    with page(standing_api) as connection:
        connection.send(text)
        assert "watch" in read(connection, "problem")["problem"]["detail"]
        assert read(connection, "robot")


def test_a_page_of_somebody_else_may_not_listen(api: httpx.Client) -> None:
    with pytest.raises(InvalidStatus) as refusal, page(api, origin="http://evil.example"):
        pass
    assert refusal.value.response.status_code == 403
    own = str(api.base_url).rstrip("/")
    with page(api, origin=own) as connection:
        assert read(connection, "robot")
