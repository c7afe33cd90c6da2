"""What the loop does now, read over HTTP as anybody could, shown as a table."""

import json
from pathlib import Path
from typing import Any, NamedTuple

import httpx
from rich.console import Group
from rich.table import Table
from rich.text import Text

from deploy.children import Family
from deploy.judging import Judging
from shared.intervals import wilson

TIMEOUT_S = 2.0


class Tally(NamedTuple):
    """What was seen of one version at work."""

    episodes: int = 0
    successes: int = 0
    corrections: int = 0


class Board:
    """Polls the API; keeps a tally of episodes by version."""

    def __init__(self, url: str, versions: Path) -> None:
        self.url = url
        self._versions = versions
        self._http = httpx.Client(base_url=f"{url}/api/v1", timeout=TIMEOUT_S)
        self._episodes: dict[str, dict[str, Any]] = {}
        self.robots: list[dict[str, Any]] = []
        self.learner: dict[str, Any] = {}
        self.reachable = False

    def refresh(self) -> None:
        """Read once; an API that is down leaves what was known."""
        try:
            self.robots = self._get("/robots")["robots"]
            self.learner = self._get("/learner") or {}
            for episode in self._get("/episodes?limit=200")["episodes"]:
                self._episodes[episode["id"]] = episode
            self.reachable = True
        except (httpx.HTTPError, json.JSONDecodeError):
            self.reachable = False

    def _get(self, path: str) -> Any:
        answer = self._http.get(path)
        answer.raise_for_status()
        return answer.json() if answer.content else None

    def versions(self) -> list[tuple[str, Path]]:
        """The versions that the learner has published, oldest first, with their checkpoints.

        A learner that takes over announces the same weights anew under its epoch: only the
        number tells them apart.
        """
        found: dict[int, tuple[int, Path]] = {}
        for card in self._versions.glob("*/card.json"):
            epoch, number = map(int, card.parent.name.split("."))
            if number not in found or epoch < found[number][0]:
                found[number] = (epoch, card.parent)
        return [(path.name, path) for _, (_, path) in sorted(found.items())]

    def tally(self) -> dict[str, Tally]:
        """By version: episodes that ended, how many succeeded, and corrections."""
        tallies: dict[str, Tally] = {}
        for episode in self._episodes.values():
            if episode["outcome"] == "aborted":
                continue
            old = tallies.get(episode["version"], Tally())
            tallies[episode["version"]] = Tally(
                old.episodes + 1,
                old.successes + (episode["outcome"] == "success"),
                old.corrections + episode["corrections"],
            )
        return tallies

    def line(self, judging: Judging) -> str:
        """One line for a log."""
        parts = [f"learner {self.learner.get('state', 'starting')}"]
        for version, tally in sorted(self.tally().items()):
            parts.append(
                f"{version}: {tally.episodes} episodes, {tally.successes} done, "
                f"{tally.corrections} corrections"
            )
        parts += [f"{name}: {row['success']:.2f}" for name, row in judging.found.items()]
        return " | ".join(parts)

    def table(self, judging: Judging, family: Family) -> Group:
        """Versions above, robots below."""
        return Group(
            Text(f"\npage: {self.url}", style="bold"),
            self.version_table(judging),
            self._robot_table(),
            Text(self._status(family), style="dim"),
        )

    def version_table(self, judging: Judging) -> Table:
        """By version: its episodes with corrections, and what an evaluation without found."""
        table = Table(title="high level", title_justify="left")
        for column in ("version", "episodes", "corrections", "success, corrected", "success alone"):
            table.add_column(column, justify="right")
        tallies = self.tally()
        for version in sorted(set(tallies) | set(judging.found), key=_order):
            tally = tallies.get(version, Tally())
            shown = f"{tally.successes}" if tally.episodes else ""
            if tally.episodes:
                low, high = wilson(tally.successes, tally.episodes)
                shown = f"{tally.successes / tally.episodes:.2f} ({low:.2f}–{high:.2f})"
            found = judging.found.get(version)
            table.add_row(
                version,
                str(tally.episodes or ""),
                str(tally.corrections or ""),
                shown,
                "{:.2f} ({:.2f}–{:.2f}), n = {}".format(
                    found["success"], *found["interval"], found["n"]
                )
                if found
                else "",
            )
        return table

    def _robot_table(self) -> Table:
        table = Table(title="robots", title_justify="left")
        for column in ("robot", "version", "episode", "step", "state", "prompt", "command"):
            table.add_column(column)
        for robot in self.robots:
            command = (robot.get("command") or {}).get("text", "")
            corrected = not str(robot.get("chosen_by", "")).replace(".", "").isdigit()
            table.add_row(
                robot["robot"],
                str(robot.get("version", "")),
                str(robot.get("number", "")),
                str(robot.get("step", "")),
                str(robot.get("state", "")),
                str(robot.get("prompt") or ""),
                Text(command, style="yellow" if corrected and command else ""),
            )
        return table

    def _status(self, family: Family) -> str:
        state = self.learner.get("state", "starting" if not self.reachable else "not heard of yet")
        restarts = sum(child.restarts for child in family.children)
        tail = f", {restarts} restarts" if restarts else ""
        reason = f": {self.learner['reason']}" if self.learner.get("reason") else ""
        return f"learner: {state}{reason}{tail}   Ctrl-C ends"


def _order(version: str) -> tuple[int, int, str]:
    epoch, dot, number = version.partition(".")
    return (int(epoch), int(number), "") if dot and epoch.isdigit() else (-1, 0, version)
