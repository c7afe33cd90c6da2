"""From words over HTTP to the learner's labels: real API, real bus messages, real store."""

from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import httpx
import pytest

from services.learner.collect import Collector
from services.learner.labels.account import faults
from services.learner.labels.aggregate import LabelSettings, derive
from services.learner.store.sql import SqlStore, sqlite_url
from services.learner.store.store import History, Manifest
from shared.clock import SystemClock
from shared.wire.codec import encode
from shared.wire.keys import robot_key
from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.fakes import FLEET, FakeRobot
from tests.integration.correction_api.running import eventually, running

SAID = "api/v1/robots/robot-1/corrections"


@pytest.fixture
def store(router: MemoryRouter, tmp_path: Path) -> Iterator[SqlStore]:
    """A learner's store, into which everything goes that a learner would take."""
    with closing(SqlStore(sqlite_url(tmp_path / "learner.db"))) as store, MemoryBus(router) as bus:
        collector = Collector(bus, FLEET, store, SystemClock())
        collector.start()
        yield store
        collector.close()


def history(store: SqlStore) -> History:
    return store.history(Manifest(marks=store.survey(Manifest()).marks))


def labels(store: SqlStore) -> dict[str, str]:
    found = derive(history(store), LabelSettings(), "5d" * 32)
    return {label.decision: label.text for label in found}


def say(api: httpx.Client, **body: Any) -> str:
    answer = api.post(SAID, json=body)
    assert answer.status_code == 201, answer.text
    return str(answer.json()["correction"]["id"])


def test_what_is_said_of_an_episode_that_is_over_changes_its_labels(
    router: MemoryRouter, store: SqlStore, tmp_path: Path
) -> None:
    with MemoryBus(router) as bus, MemoryBus(router) as robots:
        robot = FakeRobot(robots)
        with running(bus, tmp_path) as api:
            eventually(lambda: api.get("api/v1/robots").json()["robots"])
            for _ in range(3):
                decision = robot.decide()
                robots.ask(robot_key(FLEET, "robot-1", "decision"), encode(decision), timeout_s=5)
                step = robot.step
                eventually(lambda step=step: robot.step > step + 5)
            over = robot.end()
            robots.ask(robot_key(FLEET, "robot-1", "episode"), encode(over), timeout_s=5)
            eventually(lambda: api.get("api/v1/episodes").json()["episodes"])
        robot.close()
        assert labels(store) == {}
        with running(bus, tmp_path) as api:
            first, second, third = (f"{over.id}-{number}" for number in range(3))
            steps = {"first_step": 0, "end_step": over.steps}
            name = say(api, kind="relabel", episode=over.id, text="wait", **steps)
            eventually(lambda: labels(store) == {first: "wait", second: "wait", third: "wait"})
            say(api, kind="fault", decision=second)
            eventually(lambda: labels(store) == {first: "wait", third: "wait"})
            assert [fault.decisions for fault in faults(history(store))] == [(second,)]
            say(api, kind="edit", target=name, text="pick up the ham")
            eventually(lambda: set(labels(store).values()) == {"pick up the ham"})
            say(api, kind="retime", target=name, first_step=0, end_step=1)
            eventually(lambda: set(labels(store)) <= {first})
            say(api, kind="retract", target=name)
            eventually(lambda: labels(store) == {})
