"""kill -9 of the API in a storm of corrections: what was acknowledged is never lost.

Real processes: a Zenoh router and the API; robot and learner live in the test and stay up.
"""

import random
import sqlite3
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from deploy.ports import free_port
from shared.wire.bus import BusSettings, open_bus
from tests.integration.correction_api.fakes import FakeLearner, FakeRobot
from tests.integration.correction_api.processes import STARTS_WITHIN_S, Process
from tests.integration.correction_api.running import eventually

CYCLES = 3
SPEAKERS = 4


class Storm:
    """Speakers who say one thing after the other, and note what was acknowledged."""

    def __init__(self, url: str) -> None:
        self._url = url
        self._ended = threading.Event()
        self.acknowledged: list[str] = []
        self.tried = 0
        self._threads = [
            threading.Thread(target=self._speak, args=(number,)) for number in range(SPEAKERS)
        ]
        for thread in self._threads:
            thread.start()

    def end(self) -> None:
        self._ended.set()
        for thread in self._threads:
            thread.join()

    def _speak(self, speaker: int) -> None:
        with httpx.Client(timeout=5) as client:
            number = 0
            while not self._ended.is_set():
                number += 1
                name = f"say-{speaker}-{number}"
                body = {"kind": "override", "text": "pick up the cheese", "id": name}
                self.tried += 1
                try:
                    answer = client.post(self._url, json=body)
                except httpx.TransportError:
                    time.sleep(0.02)  # The API is down; there is nothing else to wait for.
                    continue
                if answer.status_code in (201, 202):
                    self.acknowledged.append(name)


@pytest.fixture
def router_port() -> Iterator[int]:
    """A router process."""
    port = free_port()
    process = Process("deploy.router", port=port)
    yield port
    assert process.end() == 0


def test_what_was_acknowledged_survives_every_kill(router_port: int, tmp_path: Path) -> None:
    chance = random.Random(7)
    endpoints = [f"tcp/127.0.0.1:{router_port}"]
    port, database = free_port(), tmp_path / "api.sqlite"
    url = f"http://127.0.0.1:{port}/api/v1"

    def start() -> Process:
        process = Process(
            "services.correction_api", port=port, database=str(database), bus__connect=endpoints
        )
        eventually(lambda: _hears(url), within_s=STARTS_WITHIN_S)
        return process

    with open_bus(BusSettings(connect=tuple(endpoints))) as bus:
        robot, learner = FakeRobot(bus), FakeLearner(bus)
        api = start()
        storm = Storm(f"{url}/robots/robot-1/corrections")
        for _ in range(CYCLES):
            enough = len(storm.acknowledged) + chance.randint(5, 40)
            eventually(lambda enough=enough: len(storm.acknowledged) >= enough)
            api.kill()
            api = start()
        storm.end()
        taken = {(kind, name) for name in storm.acknowledged for kind in ("correction", "receipt")}
        eventually(lambda: taken <= set(learner.taken))
        assert set(storm.acknowledged) <= set(robot.receipts)
        assert api.end() == 0
        robot.close()
        learner.close()
    rows = _statuses(database)
    assert {rows[name] for name in storm.acknowledged} == {"in force"}
    assert len(storm.acknowledged) < storm.tried  # The kills did hit somebody.


def _hears(url: str) -> bool:
    try:
        return bool(httpx.get(f"{url}/robots").json()["robots"])
    except httpx.TransportError:
        return False


def _statuses(database: Path) -> dict[str, str]:
    connection = sqlite3.connect(database)
    assert connection.execute("PRAGMA integrity_check").fetchone() == ("ok",)
    rows = connection.execute("SELECT id, status FROM corrections").fetchall()
    connection.close()
    assert len(rows) == len(dict(rows))
    return dict(rows)
