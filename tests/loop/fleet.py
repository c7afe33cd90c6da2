"""The whole loop in separate processes, as `hld up` starts it, and ways to look at it."""

import sqlite3
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx

from deploy.children import Child, Family
from deploy.ports import free_port
from deploy.up import Plan, start

DEADLINE_S = 120.0
STORES = {"learner": "learner/learner.db", "api": "api/corrections.sqlite"}


class Fleet:
    """Router, learner, API, robots and, where asked for, the oracle; real processes."""

    def __init__(self, folder: Path, **options: Any) -> None:
        settings: dict[str, Any] = {
            "oracle": False,
            "robots": 1,
            "rounds": 0,
            "episodes": 0,
            "evaluate": 0,
            "gate": 0,
            "report": None,
            "site": "far",
            "tasks": ("sandwich", "pack"),
            "pace": "lockstep",
            "seed": 1,
            "port": free_port(),
            "router_port": free_port(),
            "data": folder,
            "fresh": False,
            "sets": (),
        }
        self.plan = Plan(**{**settings, **options})
        self.family = Family(folder / "logs")
        self.http = httpx.Client(base_url=f"http://127.0.0.1:{self.plan.port}/api/v1", timeout=10.0)

    def __enter__(self) -> "Fleet":
        start(self.plan, self.family)
        return self

    def __exit__(self, *error: object) -> None:
        self.http.close()
        killed = self.family.end()
        if error[0] is not None:
            for child in self.family.children:
                print(f"--- {child.name}\n{child.tail(30)}")
        assert not killed, f"did not end at SIGTERM: {killed}"

    def child(self, name: str) -> Child:
        return next(child for child in self.family.children if child.name == name)

    def get(self, path: str) -> Any:
        """The body of a GET; None while the API is down or has nothing."""
        try:
            answer = self.http.get(path)
        except httpx.HTTPError:
            return None
        return answer.json() if answer.status_code == 200 else None

    def wait_for(self, look: Callable[[], Any], what: str, deadline_s: float = DEADLINE_S) -> Any:
        """Look until there is something to see, minding the processes meanwhile."""
        end = time.monotonic() + deadline_s
        while not (seen := look()):
            assert time.monotonic() < end, f"{what}: not within {deadline_s} s"
            self.family.mind()
            time.sleep(0.05)
        return seen

    def robot(self, name: str = "robot-1") -> dict[str, Any]:
        """One robot, once it acts."""

        def look() -> Any:
            robot = self.get(f"/robots/{name}")
            return robot if robot and robot.get("episode") and robot.get("command") else None

        return dict(self.wait_for(look, f"{name} acts"))

    def read(self, store: str, query: str) -> list[tuple[Any, ...]]:
        """Rows of a service's database, read beside whoever writes it."""
        path = self.plan.data / STORES[store]
        with sqlite3.connect(f"file:{path}?mode=ro", uri=True) as database:
            return database.execute(query).fetchall()
