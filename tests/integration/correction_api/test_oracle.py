"""The oracle over real HTTP: it brings a robot with a useless policy to its goal."""

import asyncio
import os
import signal
import subprocess
import sys
import threading
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx

from deploy.ports import free_port
from services.oracle.build import build
from services.oracle.config import OracleSettings
from services.oracle.loop import run
from shared.messages.correction import Correction
from shared.messages.receipt import Receipt
from shared.service import Stop
from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.fakes import FakeRobot
from tests.integration.correction_api.running import WITHIN_S, eventually, running
from tests.unit.oracle.scenes import scene

WISH = ("bread", "cheese", "tomato", "toast")  # What the fake robot's prompt asks for.


class Waiting(FakeRobot):
    """Supervised: does what its command says at once, then asks again; proposes the same always."""

    def __init__(self, bus: MemoryBus, name: str) -> None:
        self._verdict = threading.Event()
        super().__init__(bus, name, supervised=True)
        self.stack: list[str] = []
        self.hand: str | None = None
        self._worker = threading.Thread(target=self._work, daemon=True)
        self._worker.start()

    @property
    def done(self) -> bool:
        return tuple(self.stack) == WISH

    def _work(self) -> None:
        while not self.done and not self._ended.is_set():
            state = scene(*self.stack, hand=self.hand)
            decision = self.decide(truth=state.to_json())
            self._verdict.clear()
            while not self._verdict.wait(0.2) and not self._ended.is_set():
                self.repeat(decision)
            self._obey_command()

    def _obey_command(self) -> None:
        if self.command == "put it on the plate" and self.hand:
            self.stack.append(self.hand)
            self.hand = None
        elif self.command.startswith("pick up the ") and not self.hand:
            self.hand = self.command.removeprefix("pick up the ")

    def _judge(self, correction: Correction) -> Receipt:
        receipt = super()._judge(correction)
        if receipt.accepted:
            self._verdict.set()
        return receipt


@contextmanager
def oracle(url: str, **settings: Any) -> Iterator[Counter[str]]:
    """An oracle in a thread; yields its counts, filled at the end."""
    made = OracleSettings.model_validate({"url": url, "wait_s": 1.0} | settings)
    stop, counts = Stop(), Counter[str]()

    async def attend() -> None:
        counts.update(await run(build(made), made, stop))

    thread = threading.Thread(target=lambda: asyncio.run(attend()))
    thread.start()
    try:
        yield counts
    finally:
        stop.set()
        thread.join(WITHIN_S)
        assert not thread.is_alive()


def history(api: httpx.Client) -> list[dict[str, Any]]:
    said = api.get("api/v1/corrections", params={"limit": 200}).json()["corrections"]
    return list(said)


def test_two_robots_are_led_to_their_goals_while_the_api_restarts(tmp_path: Path) -> None:
    router, port = MemoryRouter(), free_port()
    with MemoryBus(router) as bus, MemoryBus(router) as robots:
        first, second = (Waiting(robots, name) for name in ("robot-1", "robot-2"))
        with oracle(f"http://127.0.0.1:{port}") as counts:
            with running(bus, tmp_path, port=port):
                eventually(lambda: first.heard and second.heard)
            with running(bus, tmp_path, port=port) as api:
                eventually(lambda: first.done and second.done)
                # A robot obeys a moment before its receipt is on disk.
                eventually(lambda: {view["status"] for view in history(api)} == {"in force"})
                said = history(api)
        for robot in (first, second):
            robot.close()
    assert {view["correction"]["author"] for view in said} == {"oracle"}
    assert counts["override"] >= 12
    assert counts["refused"] == 0


def test_it_ends_cleanly_when_it_is_told_to(tmp_path: Path) -> None:
    log = tmp_path / "log"
    command = [
        sys.executable,
        "-m",
        "services.oracle",
        "--set",
        f"url=http://127.0.0.1:{free_port()}",
    ]
    with log.open("w") as stderr:
        process = subprocess.Popen(command, stderr=stderr)
        eventually(lambda: "the API does not answer" in log.read_text())
        os.kill(process.pid, signal.SIGTERM)
        assert process.wait(WITHIN_S) == 0
    assert "ended" in log.read_text()
