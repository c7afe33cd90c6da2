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
    """What was seen of one version at work; `corrections` are overrides."""

    episodes: int = 0
    successes: int = 0
    corrections: int = 0


class Made(NamedTuple):
    """A version that the learner has put on its shelf.

    episodes, corrections: new in the round that made it. labels: decisions that it learned from,
    of all rounds; held_out: those that the gate kept aside.
    """

    name: str
    folder: Path
    episodes: int = 0
    corrections: int = 0
    labels: int = 0
    held_out: int = 0


class Board:
    """Polls the API; keeps a tally of episodes by version."""

    def __init__(self, url: str, versions: Path) -> None:
        self.url = url
        self._versions = versions
        self._http = httpx.Client(base_url=f"{url}/api/v1", timeout=TIMEOUT_S)
        self._tally: dict[str, Tally] = {}
        self._hashes: dict[str, set[str]] = {}
        self.robots: list[dict[str, Any]] = []
        self.learner: dict[str, Any] = {}
        self.reachable = False

    def refresh(self) -> None:
        """Read once; an API that is down leaves what was known."""
        try:
            self.robots = self._get("/robots")["robots"]
            self.learner = self._get("/learner") or {}
            seen = self._get("/episodes?limit=50")
            for row in seen["tally"]:
                name = row.pop("version")
                self._tally[name] = Tally(**row)
            for episode in seen["episodes"]:
                found = self._hashes.setdefault(episode["version"], set())
                found.add(episode["low_level_sha256"])
            self.reachable = True
        except (httpx.HTTPError, json.JSONDecodeError):
            self.reachable = False

    def _get(self, path: str) -> Any:
        answer = self._http.get(path)
        answer.raise_for_status()
        return answer.json() if answer.content else None

    def versions(self) -> list[Made]:
        """The versions that the learner has published, oldest first.

        A learner that takes over announces the same weights anew under its epoch: only the
        number tells them apart.
        """
        found: dict[int, Path] = {}
        for card in sorted(self._versions.glob("*/card.json")):
            found.setdefault(int(card.parent.name.partition(".")[2]), card.parent)
        return [_made(path) for _, path in sorted(found.items())]

    def tally(self) -> dict[str, Tally]:
        """By version as robots ran it: episodes that ended, how many succeeded, corrections."""
        return dict(self._tally)

    def low_level(self, number: str) -> set[str]:
        """The low levels, by their hash in the robots' memory, under versions of this number."""
        return set().union(
            *(found for name, found in self._hashes.items() if name.partition(".")[2] == number)
        )

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
        """By version: its episodes with corrections, and its success alone, in the evaluation."""
        table = Table(title="high level", title_justify="left")
        n = next((row["n"] for row in judging.found.values()), 0)
        alone = f"alone, n = {n}" if n else "alone"
        columns = ("version", "episodes", "corrections", "success, corrected", alone)
        for column in columns:
            table.add_column(column, justify="right")
        numbers = sorted({_number(name) for name in (*self._tally, *judging.found)})
        for number in numbers:
            names = [name for name in self._tally if _number(name) == number]
            tally = Tally(*map(sum, zip(*(self._tally[name] for name in names), strict=True)))
            judged = next((row for n, row in judging.found.items() if _number(n) == number), None)
            name = "oracle" if number < 0 else min(names, default=f"1.{number}")
            table.add_row(name, *_work(tally), _rate(judged))
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
                Text(str(robot.get("prompt") or "")),
                Text(command, style="yellow" if corrected and command else ""),
            )
        return table

    def _status(self, family: Family) -> str:
        state = self.learner.get("state", "starting" if not self.reachable else "not heard of yet")
        restarts = sum(child.restarts for child in family.children)
        tail = f", {restarts} restarts" if restarts else ""
        reason = f": {self.learner['reason']}" if self.learner.get("reason") else ""
        return f"learner: {state}{reason}{tail}   Ctrl-C ends"


def _made(folder: Path) -> Made:
    """What the learner wrote beside a checkpoint; the base was made by no round."""
    file = folder / "round.json"
    if not file.exists():
        return Made(folder.name, folder)
    told = json.loads(file.read_text())
    manifest, figures = told["manifest"], told["figures"]
    return Made(
        folder.name,
        folder,
        manifest["episodes"],
        manifest["corrections"],
        figures["labels"],
        figures["held_out"],
    )


def _number(version: str) -> int:
    """The second half of a version; -1 for the oracle, which has none."""
    number = version.partition(".")[2]
    return int(number) if number.isdigit() else -1


def _work(tally: Tally) -> tuple[str, str, str]:
    if not tally.episodes:
        return ("", "", "")
    low, high = wilson(tally.successes, tally.episodes)
    return (
        str(tally.episodes),
        f"{tally.corrections} ({tally.corrections / tally.episodes:.1f} each)",
        f"{tally.successes / tally.episodes:.2f} ({low:.2f}–{high:.2f})",
    )


def _rate(judged: dict[str, Any] | None) -> str:
    if not judged:
        return ""
    low, high = judged["interval"]
    return f"{judged['success']:.2f} ({low:.2f}–{high:.2f})"
