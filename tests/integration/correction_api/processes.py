"""Real processes: a service as `python -m` starts it, and a cell of router, robots and API."""

import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx

from deploy.ports import free_port
from tests.integration.correction_api.running import eventually

ENDS_WITHIN_S = 120.0
STARTS_WITHIN_S = 180.0  # An actor loads its policies first.


class Process:
    """`python -m MODULE --set …`, killed or ended by its id."""

    def __init__(
        self, module: str, log: Path | None = None, config: Path | None = None, **sets: object
    ) -> None:
        """log: where it writes what it has to say; the test's own output otherwise.

        config: its settings file.
        """
        words = [f"{name.replace('__', '.')}={json.dumps(value)}" for name, value in sets.items()]
        arguments = ["--config", str(config)] if config else []
        arguments += [part for word in words for part in ("--set", word)]
        stderr = log.open("wb") if log else None
        self._popen = subprocess.Popen([sys.executable, "-m", module, *arguments], stderr=stderr)
        if stderr:
            stderr.close()

    def signal(self, number: int) -> None:
        os.kill(self._popen.pid, number)

    def kill(self) -> None:
        os.kill(self._popen.pid, signal.SIGKILL)
        self._popen.wait(10)

    def end(self) -> int:
        self._popen.terminate()
        return self._popen.wait(ENDS_WITHIN_S)


class Cell:
    """Router, API and one actor whose robots work in real time, in episodes that don't end soon."""

    def __init__(
        self,
        folder: Path,
        robots: int = 2,
        actor: dict[str, Any] | None = None,
        apart: bool = False,
        **settings: Any,
    ) -> None:
        """actor: its settings. apart: an actor for each robot. settings: those of the API."""
        self._router_port, self._port = free_port(), free_port()
        self._settings = {"database": str(folder / "api.sqlite")} | settings
        self._bus = {"bus__connect": [f"tcp/127.0.0.1:{self._router_port}"]}
        self.robots = [f"robot-{number + 1}" for number in range(robots)]
        crews = [[robot] for robot in self.robots] if apart else [self.robots]
        self.logs = [folder / f"actor-{number}.log" for number, _ in enumerate(crews, 1)]
        self._processes = [
            Process("deploy.router", port=self._router_port),
            *(
                Process(
                    "services.actor",
                    log,
                    id=log.stem,
                    robots=crew,
                    data=str(folder / log.stem),
                    wait_for_policy_s=0,
                    **({"rollout__max_steps": 100_000} | (actor or {})),
                    **self._bus,
                )
                for log, crew in zip(self.logs, crews, strict=True)
            ),
        ]
        self._api = self._start()
        token = settings.get("token")
        headers = {"Authorization": f"Bearer {token}"} if token else {}
        self.http = httpx.Client(base_url=self.url, timeout=15, headers=headers)

    @property
    def url(self) -> str:
        """Where the page is."""
        return f"http://127.0.0.1:{self._port}{self._settings.get('prefix', '')}/"

    def __enter__(self) -> "Cell":
        eventually(self._at_work, within_s=STARTS_WITHIN_S)
        return self

    def __exit__(self, *error: object) -> None:
        self.http.close()
        ends = [process.end() for process in (self._api, *reversed(self._processes))]
        assert ends == [0] * len(ends), self.logs[0].read_text()[-2000:]

    def kill(self) -> None:
        """kill -9 of the API."""
        self._api.kill()

    @contextmanager
    def hanging(self) -> Iterator[None]:
        """The API takes connections and does nothing, as one that hangs."""
        self._api.signal(signal.SIGSTOP)
        try:
            yield
        finally:
            self._api.signal(signal.SIGCONT)

    def restart(self) -> None:
        """Start the API again, on its port and with its data."""
        self._api = self._start()
        eventually(self._hears, within_s=STARTS_WITHIN_S)

    def correct(self, robot: str = "robot-1", **body: Any) -> dict[str, Any]:
        """Say something over HTTP."""
        answer = self.http.post(f"api/v1/robots/{robot}/corrections", json=body)
        assert answer.status_code == 201, answer.text
        return dict(answer.json())

    def said(self) -> list[dict[str, Any]]:
        """Everything that was said, the newest first."""
        return list(self.http.get("api/v1/corrections?limit=200").json()["corrections"])

    def figure(self, name: str) -> float:
        """A figure of the API's metrics, by its name and labels; 0 before it was counted."""
        text = self.http.get("metrics").text
        found = re.search(rf"^{re.escape(name)} (\S+)$", text, re.MULTILINE)
        return float(found.group(1)) if found else 0.0

    def _start(self) -> Process:
        return Process("services.correction_api", port=self._port, **self._settings, **self._bus)

    def _hears(self) -> list[Any]:
        try:
            return list(self.http.get("api/v1/robots").json()["robots"])
        except httpx.TransportError:
            return []

    def _at_work(self) -> bool:
        heard = self._hears()
        return len(heard) == len(self.robots) and all(robot["decision"] for robot in heard)
