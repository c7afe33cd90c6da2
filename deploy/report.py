"""The report of a run: each version with its success, n and interval, as JSON and as a plot."""

import json
import os
from pathlib import Path
from typing import Any

from deploy.board import Board
from deploy.judging import Judging
from shared.errors import HldError


class Report:
    """Written anew whenever there is more to say, so that a broken-off run has one, too.

    schema 1: `versions[0]` is the base. `episodes` and `corrections` of a version are those of
    all rounds up to it, so they grow from row to row; `labels` are the decisions that it learned
    from, `held_out` those that the gate kept aside. `complete`: all was done that was asked for.
    """

    def __init__(
        self,
        path: Path | None,
        tasks: tuple[str, ...],
        site: str,
        board: Board,
        judging: Judging,
        rounds: int,
    ) -> None:
        self.path, self._tasks, self._site = path, tasks, site
        self._board, self._judging, self._rounds = board, judging, rounds
        self._written: dict[str, Any] = {}

    def complete(self) -> bool:
        """All rounds are over, and everything that shall be evaluated is.

        Raises:
            HldError: the learner stopped, or refused a candidate, so that it never will be.
        """
        versions = self._board.versions()
        learner = self._board.learner
        over = int(learner.get("round", 0)) >= self._rounds
        if learner.get("state") == "stopped" or (
            over and learner.get("state") == "collecting" and len(versions) <= self._rounds
        ):
            reason = learner.get("reason") or "the gate refused one; `hld policy list` says why"
            raise HldError(f"not every one of {self._rounds} rounds made a version: {reason}")
        return self._done()

    def _done(self) -> bool:
        versions = self._board.versions()
        wanted = {"oracle", *(made.name for made in versions)} if self._judging.episodes else set()
        return 0 < self._rounds < len(versions) and wanted <= set(self._judging.found)

    def write(self) -> None:
        """Write the report, if there is a file for it and something has changed."""
        content = self.content()
        if self.path is None or content == self._written:
            return
        self._written = content
        self.path.parent.mkdir(parents=True, exist_ok=True)
        fresh = self.path.with_suffix(".new")
        fresh.write_text(json.dumps(content, indent=2) + "\n")
        os.replace(fresh, self.path)

    def content(self) -> dict[str, Any]:
        """What is known so far."""
        oracle = self._judging.found.get("oracle")
        return {
            "schema": 1,
            "complete": self._done(),
            "tasks": list(self._tasks),
            "site": self._site,
            "low_level_sha256": self._low_level(),
            "oracle": _figures(oracle) if oracle else None,
            "versions": self._rows(),
        }

    def _low_level(self) -> dict[str, str]:
        """The low level under the base and under the newest version, hashed in the memory of the
        robots and evaluations that ran it; several hashes would stand side by side."""
        names = [made.name for made in self._board.versions()] or [""]
        told = {}
        for moment, name in (("before", names[0]), ("after", names[-1])):
            judged = self._judging.found.get(name, {}).get("low_level_sha256", [])
            found = self._board.low_level(name.partition(".")[2]) | set(judged)
            told[moment] = ", ".join(sorted(found))
        return told

    def _rows(self) -> list[dict[str, Any]]:
        rows, episodes, corrections = [], 0, 0
        for made in self._board.versions():
            episodes, corrections = episodes + made.episodes, corrections + made.corrections
            row: dict[str, Any] = {
                "version": made.name,
                "episodes": episodes,
                "corrections": corrections,
                "labels": made.labels,
                "held_out": made.held_out,
            }
            if made.name in self._judging.found:
                row |= _figures(self._judging.found[made.name])
            rows.append(row)
        return rows

    def plot(self) -> Path | None:
        """Draw success by version beside the JSON; None when there is nothing to draw."""
        content = self.content()
        rows = [row for row in content["versions"] if "success" in row]
        if self.path is None or not rows:
            return None
        from matplotlib.figure import Figure  # Late: it takes a second, and few runs plot.

        figure = Figure(figsize=(6, 3.6), layout="constrained")
        axes = figure.subplots()
        middle = [row["success"] for row in rows]
        below = [row["success"] - row["interval"][0] for row in rows]
        above = [row["interval"][1] - row["success"] for row in rows]
        names = [f"{row['version']}\n{row['corrections']} corrections" for row in rows]
        axes.errorbar(
            names, middle, yerr=[below, above], fmt="o-", color="#1f5fa8", capsize=4, lw=2,
            label=f"high level, n = {rows[0]['n']} each",
        )  # fmt: skip
        if oracle := content["oracle"]:
            axes.axhspan(*oracle["interval"], color="#2e8b57", alpha=0.15, lw=0)
            axes.axhline(oracle["success"], color="#2e8b57", label="oracle, same low level")
        axes.set(ylim=(0, 1), ylabel="success", title=f"{', '.join(self._tasks)} at {self._site}")
        axes.spines[["top", "right"]].set_visible(False)
        axes.legend(loc="best", frameon=False)
        path = self.path.with_suffix(".svg")
        figure.savefig(path)
        return path


def _figures(summary: dict[str, Any]) -> dict[str, Any]:
    return {key: summary[key] for key in ("success", "n", "interval")} | {"tasks": summary["tasks"]}
