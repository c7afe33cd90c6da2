"""Robots in doubt: in the queue, on the live connection, and gone when they were helped."""

import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest
from websockets.sync.client import connect

from shared.messages.heartbeat import RobotState
from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.fakes import COMMANDS, FakeRobot
from tests.integration.correction_api.running import eventually, running
from tests.unit.actor.bench import Bench
from tests.unit.rollout.fakes import ScoringHighLevel

HELP = "api/v1/help"


def asking(api: httpx.Client) -> list[dict[str, Any]]:
    return list(api.get(HELP).json()["asking"])


def say(api: httpx.Client, **words: Any) -> dict[str, Any]:
    answer = api.post("api/v1/robots/robot-1/corrections", json={"author": "ada", **words})
    assert answer.status_code == 201, answer.text
    return dict(answer.json())


def test_a_robot_in_doubt_is_told_with_all_that_a_person_needs(
    api: httpx.Client, robot: FakeRobot
) -> None:
    assert api.get(HELP).json() == {"asking": [], "suppressed": 0}
    decision = robot.ask(doubt=0.625, waits_s=30)
    (told,) = eventually(lambda: asking(api))
    assert (told["robot"], told["episode"], told["decision"]) == (
        "robot-1",
        robot.episode,
        decision.id,
    )
    assert (told["reason"], told["doubt"]) == ("entropy", 0.625)
    assert 0 < told["waits_s"] <= 30
    assert [entry["goal"]["text"] for entry in told["proposed"]] == list(COMMANDS[:3])
    eventually(lambda: api.get("api/v1/robots/robot-1").json()["state"] == "asking")


@pytest.mark.parametrize("words", [{"kind": "override", "text": "wait"}, {"kind": "approve"}])
def test_who_answers_takes_it_off_the_queue_at_once(
    api: httpx.Client, robot: FakeRobot, words: dict[str, str]
) -> None:
    decision = robot.ask()
    eventually(lambda: asking(api))
    say(api, **words, decision=decision.id)
    assert asking(api) == []
    assert "hldagger_help_answered_total 1.0" in api.get("metrics").text


def test_a_call_is_gone_when_the_robot_is_sure_again_or_its_episode_is_over(
    api: httpx.Client, robot: FakeRobot
) -> None:
    robot.ask()
    eventually(lambda: asking(api))
    robot.help = None
    robot.decide()
    eventually(lambda: not asking(api))
    robot.ask()
    eventually(lambda: asking(api))
    robot.end()
    eventually(lambda: not asking(api))


def test_a_robot_that_falls_silent_asks_for_nothing(
    router: MemoryRouter, robot: FakeRobot, tmp_path: Path
) -> None:
    watch = {"stale_s": 0.3, "offline_s": 0.6}
    with MemoryBus(router) as bus, running(bus, tmp_path, watch=watch) as api:
        eventually(lambda: api.get("api/v1/robots").json()["robots"])
        robot.ask()
        eventually(lambda: asking(api))
        robot.deaf = True
        eventually(lambda: not asking(api))


def test_beyond_the_budget_of_the_fleet_a_robot_is_not_shown(
    router: MemoryRouter, robot: FakeRobot, tmp_path: Path
) -> None:
    with MemoryBus(router) as bus, running(bus, tmp_path, help={"per_hour": 1}) as api:
        eventually(lambda: api.get("api/v1/robots").json()["robots"])
        decision = robot.ask()
        eventually(lambda: asking(api))
        say(api, kind="approve", decision=decision.id)
        robot.ask()
        shown = eventually(lambda: (body := api.get(HELP).json())["suppressed"] and body)
        assert shown == {"asking": [], "suppressed": 1}
        assert "hldagger_help_suppressed_total 1.0" in api.get("metrics").text


def test_an_open_page_is_told_of_each_change(api: httpx.Client, robot: FakeRobot) -> None:
    url = str(api.base_url.join("api/v1/live")).replace("http", "ws")
    with connect(url) as socket:

        def heard(count: int) -> None:
            while True:
                message = socket.recv(timeout=15)
                told = json.loads(message) if isinstance(message, str) else {}
                if told.get("type") == "help" and len(told["help"]["asking"]) == count:
                    return

        heard(0)
        decision = robot.ask()
        heard(1)
        say(api, kind="approve", decision=decision.id)
        heard(0)


@contextmanager
def working(folder: Path, router: MemoryRouter, wait_s: float) -> Iterator[Bench]:
    """An actor's robot whose high level can't decide, turning in a thread of its own."""
    help_settings = {"threshold": 0.4, "wait_s": wait_s}
    bench = Bench(folder, router, rollout={"max_steps": 10**5}, help=help_settings)
    bench.refresh.newest = ScoringHighLevel(0.5)  # type: ignore[assignment]
    ended = threading.Event()

    def turn() -> None:
        while not ended.is_set():
            if not bench.runner.tick():
                ended.wait(0.002)

    thread = threading.Thread(target=turn)
    thread.start()
    yield bench
    ended.set()
    thread.join()
    bench.close()


def test_an_unsure_robot_stands_still_until_it_is_corrected_over_http(
    router: MemoryRouter, tmp_path: Path
) -> None:
    with MemoryBus(router) as bus, running(bus, tmp_path) as api:
        with working(tmp_path, router, wait_s=3600) as bench:
            (told,) = eventually(lambda: asking(api))
            assert (told["robot"], told["reason"]) == ("robot-1", "entropy")
            assert told["waits_s"] > 3000
            assert bench.robot.actions == []
            said = say(api, kind="override", text="sideways", decision=told["decision"])
            assert said["receipt"]["step"] == 0
            eventually(lambda: len(bench.robot.actions) > 20)
            assert {int(action[0]) for action in bench.robot.actions[:20]} == {len("sideways")}
            assert asking(api) == []
            eventually(lambda: bench.heard["heartbeat"][-1].state is RobotState.ACTING)


def test_a_robot_whom_nobody_helps_carries_on_after_a_while_and_is_counted(
    router: MemoryRouter, tmp_path: Path
) -> None:
    with MemoryBus(router) as bus, running(bus, tmp_path) as api:
        with working(tmp_path, router, wait_s=3.0) as bench:
            (told,) = eventually(lambda: asking(api))
            assert told["waits_s"] > 0
            eventually(lambda: len(bench.robot.actions) > 20)
            assert {int(action[0]) for action in bench.robot.actions[:20]} == {len("left")}
            eventually(lambda: "hldagger_help_expired_total 1.0" in api.get("metrics").text)
            (still,) = asking(api)  # It is in doubt still, and whoever has time may help.
            assert (still["decision"], still["waits_s"]) == (told["decision"], 0)
