"""One request that stops every robot: none is told twice, and none waits for one that is gone."""

import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest

from services.correction_api.people import fresh_token, hashed
from shared.messages.heartbeat import RobotState
from shared.wire.keys import robot_key
from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.fakes import FLEET, FakeRobot
from tests.integration.correction_api.running import eventually, running

PAUSE = "api/v1/pause"


@contextmanager
def fleet(router: MemoryRouter, count: int) -> Iterator[list[FakeRobot]]:
    """robot-1 and so on, all at work."""
    with ExitStack() as stack:
        robots = []
        for number in range(1, count + 1):
            bus = stack.enter_context(MemoryBus(router))
            robots.append(FakeRobot(bus, f"robot-{number}"))
            stack.callback(robots[-1].close)
        yield robots


@contextmanager
def hearing(router: MemoryRouter, folder: Path, count: int, **settings: Any) -> Iterator[Any]:
    """An API that has heard of so many robots."""
    with MemoryBus(router) as bus, running(bus, folder, **settings) as api:
        eventually(lambda: len(api.get("api/v1/robots").json()["robots"]) == count)
        yield api


def stop(api: httpx.Client, **body: Any) -> dict[str, dict[str, Any]]:
    """What became of it, by robot."""
    answer = api.post(PAUSE, json=body)
    assert answer.status_code == 200, answer.text
    return {one["robot"]: one for one in answer.json()["robots"]}


def test_one_request_stops_every_robot_and_the_same_again_says_nothing_twice(
    router: MemoryRouter, tmp_path: Path
) -> None:
    few = {"asking": 2}  # Fewer than there are robots.
    with fleet(router, 12) as robots, hearing(router, tmp_path, 12, delivery=few) as api:
        told = stop(api, id="stop-1", author="anna")
        assert {one["status"] for one in told.values()} == {"in force"}
        assert [robot.state for robot in robots] == [RobotState.PAUSED] * 12
        said = [one["correction"]["correction"] for one in told.values()]
        assert {one["author"] for one in said} == {"anna"}
        assert len({one["id"] for one in said}) == 12
        assert stop(api, id="stop-1", author="anna") == told
        assert [len(robot.heard) for robot in robots] == [1] * 12
        again = api.post(PAUSE, headers={"Idempotency-Key": "stop-2"}).json()
        assert again["id"] == "stop-2"
        assert [len(robot.heard) for robot in robots] == [2] * 12


def test_a_robot_that_is_gone_or_hangs_keeps_no_other_one_moving(
    router: MemoryRouter, tmp_path: Path
) -> None:
    released = threading.Event()

    def hang(key: str, payload: bytes) -> bytes:
        del key, payload  # Unused: it answers nobody.
        released.wait()
        return b""

    one_at_a_time = {"asking": 1, "ask_s": 60.0}
    silent = {"stale_s": 1.0, "offline_s": 3.0}
    with fleet(router, 3) as robots, MemoryBus(router) as bus:
        settings = {"delivery": one_at_a_time, "watch": silent}
        with hearing(router, tmp_path, 3, **settings) as api:
            for robot in robots[:2]:
                robot.close()
            hanging = bus.serve(robot_key(FLEET, "robot-2", "correction"), hang)
            presences = {"robot-1": "offline", "robot-2": "offline", "robot-3": "online"}
            eventually(lambda: _presences(api) == presences)
            told = stop(api)
            assert robots[2].state is RobotState.PAUSED
            assert told["robot-3"]["status"] == "in force"
            for name in ("robot-1", "robot-2"):
                assert told[name]["status"] == "pending"
                assert "no receipt yet, offline for" in told[name]["reason"]
            released.set()
        hanging.close()


def test_a_robot_between_two_episodes_is_told_at_once(router: MemoryRouter, tmp_path: Path) -> None:
    with fleet(router, 2) as (idle, other), hearing(router, tmp_path, 2) as api:
        idle.episode = None
        eventually(lambda: api.get("api/v1/robots/robot-1").json()["episode"] is None)
        told = stop(api, id="stop-1")
        assert [one["status"] for one in told.values()] == ["in force"] * 2
        assert (idle.state, idle.heard[0].episode) == (RobotState.PAUSED, "robot-1-e1")
        assert stop(api, id="stop-1") == told
        assert (len(idle.heard), len(other.heard)) == (1, 1)


def test_a_robot_of_which_no_episode_is_known_is_told_as_soon_as_one_is(
    router: MemoryRouter, tmp_path: Path
) -> None:
    with fleet(router, 1) as (idle,):
        idle.episode = None
        with hearing(router, tmp_path, 1) as api, ThreadPoolExecutor(1) as pool:
            eventually(lambda: api.get("api/v1/robots/robot-1").json()["episode"] is None)
            answer = pool.submit(stop, api, id="stop-1")
            idle.episode = "robot-1-e2"
            assert answer.result()["robot-1"]["status"] == "in force"
        assert [one.episode for one in idle.heard] == ["robot-1-e2"]


def test_a_robot_that_has_just_begun_another_episode_stands_still_in_that_one(
    router: MemoryRouter, tmp_path: Path
) -> None:
    with fleet(router, 1) as (robot,), hearing(router, tmp_path, 1) as api:
        robot.deaf, robot.episode = True, "robot-1-e2"  # Nobody has heard of it yet.
        told = stop(api, id="stop-1")
        assert told["robot-1"]["status"] == "in force"
        assert robot.state is RobotState.PAUSED


def test_robots_that_are_named_are_stopped_and_no_others(
    router: MemoryRouter, tmp_path: Path
) -> None:
    with fleet(router, 2) as (one, other), hearing(router, tmp_path, 2) as api:
        told = stop(api, robots=["robot-2"])
        assert (list(told), told["robot-2"]["status"]) == (["robot-2"], "in force")
        assert (one.heard, other.state) == ([], RobotState.PAUSED)
        unknown = api.post(PAUSE, json={"robots": ["robot-9"]})
        assert (unknown.status_code, unknown.json()["detail"][:15]) == (404, "no robot 'robot")


def test_it_is_said_of_each_robot_why_it_does_not_stand_still(
    router: MemoryRouter, tmp_path: Path
) -> None:
    with fleet(router, 3) as (idle, stubborn, _), MemoryBus(router) as bus:
        idle.episode, stubborn.reason = None, "the brake is open"
        idle.beat()
        with running(bus, tmp_path) as api:
            eventually(lambda: len(api.get("api/v1/robots").json()["robots"]) == 3)
            eventually(lambda: api.get("api/v1/robots/robot-1").json()["episode"] is None)
            told = stop(api)
            assert {name: one["status"] for name, one in told.items()} == {
                "robot-1": "refused",
                "robot-2": "refused",
                "robot-3": "in force",
            }
            assert "robot-1 is between two episodes" in told["robot-1"]["reason"]
            assert told["robot-1"]["correction"] is None
            assert told["robot-2"]["reason"] == "the brake is open"
            kept = api.get("api/v1/corrections?robot=robot-2").json()["corrections"]
            assert kept == [told["robot-2"]["correction"]]


def test_a_robot_that_is_heard_of_just_after_a_start_is_stopped_too(
    router: MemoryRouter, tmp_path: Path
) -> None:
    with MemoryBus(router) as bus, running(bus, tmp_path, watch={"settle_s": 3.0}) as api:
        with ThreadPoolExecutor(1) as pool:
            answer = pool.submit(stop, api)
            with fleet(router, 1) as (robot,):
                assert answer.result()["robot-1"]["status"] == "in force"
                assert robot.state is RobotState.PAUSED


def test_without_robots_nothing_is_stopped(router: MemoryRouter, tmp_path: Path) -> None:
    with MemoryBus(router) as bus, running(bus, tmp_path) as api:
        assert stop(api) == {}


def test_everybody_who_has_a_token_stops_all_robots_under_their_own_name(
    router: MemoryRouter, tmp_path: Path
) -> None:
    token = fresh_token()
    with fleet(router, 1) as (robot,), MemoryBus(router) as bus:
        with running(bus, tmp_path, people={"anna": hashed(token)}) as api:
            assert api.post(PAUSE).status_code == 401
            api.headers["Authorization"] = f"Bearer {token}"
            eventually(lambda: api.get("api/v1/robots").json()["robots"])
            assert api.post(PAUSE, json={"author": "ben"}).status_code == 403
            assert robot.heard == []
            assert stop(api)["robot-1"]["status"] == "in force"
            assert [one.author for one in robot.heard] == ["anna"]


@pytest.mark.parametrize("body", [{"robot": "robot-1"}, {"id": "No"}, {"begun_ns": -1}])
def test_what_cannot_be_meant_stops_nobody(
    api: httpx.Client, robot: FakeRobot, body: dict[str, Any]
) -> None:
    assert api.post(PAUSE, json=body).status_code == 422
    twice = api.post(PAUSE, json={"id": "one"}, headers={"Idempotency-Key": "other"})
    assert twice.status_code == 422
    assert robot.heard == []


def _presences(api: httpx.Client) -> dict[str, str]:
    robots = api.get("api/v1/robots").json()["robots"]
    return {robot["robot"]: robot["presence"] for robot in robots}
