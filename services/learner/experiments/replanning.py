"""How often to ask a high level that takes its time: success and queries by interval and delay."""

from typing import Any

from services.learner.experiments.bench import Bench, slug
from services.learner.experiments.findings import Findings, Panel, Plot, Table, cell, curve
from shared.evaluation.plan import ORACLE
from shared.evaluation.summary import summarize

HZ = 50.0
DELAYS = (0, 20, 50)
"""Control steps from a question to its answer: at once, 0.4 s, 1 s."""
INTERVALS = (10, 20, 50, 100, 150)
"""Control steps from one question to the next; never less than the delay, since a question is
forgotten when the next one is put."""


def run(bench: Bench) -> Findings:
    """Each interval under each delay, for the oracle and the learned high level."""
    figures = {
        high: {str(delay): _swept(bench, high, delay) for delay in DELAYS}
        for high in (ORACLE, bench.high_level)
    }
    return Findings(
        title="Replanning: interval, delay and cost",
        method=(
            "The high level is asked every so many control steps (50 a second) and answers so many "
            "steps later, about what it saw when it was asked; meanwhile the command in force "
            "stays. A query is one question.",
            "The same scenes in each cell.",
        ),
        figures=figures,
        tables=tuple(_table(high, by_delay) for high, by_delay in figures.items()),
        plots=(
            Plot(
                name="replanning",
                title=f"Success over the replanning interval, {bench.site}",
                x_label="seconds from one query to the next",
                panels=tuple(_panel(high, by_delay) for high, by_delay in figures.items()),
            ),
        ),
        notes=(
            "One training seed of each policy. The base was trained on looks every 0.4 s.",
            "Intervals are Wilson's, 95 %.",
        ),
    )


def _swept(bench: Bench, high: str, delay: int) -> dict[str, Any]:
    """By interval: success, steps and queries an episode."""
    return {
        str(interval): _cell(bench, high, delay, interval)
        for interval in INTERVALS
        if interval >= delay
    }


def _cell(bench: Bench, high: str, delay: int, interval: int) -> dict[str, Any]:
    rollout = {"latency_steps": delay, "decision_steps": interval}
    plan = bench.plan(high_level=high, rollout=rollout)
    rows = bench.episodes(f"{slug(high)}-delay-{delay}-every-{interval}", plan)
    summary = summarize(rows)
    return {key: summary[key] for key in ("success", "n", "interval", "steps", "decisions")}


def _panel(high: str, by_delay: dict[str, Any]) -> Panel:
    curves = (
        curve(
            f"answers after {seconds(delay)} s",
            {int(interval) / HZ: found for interval, found in swept.items()},
        )
        for delay, swept in by_delay.items()
    )
    return Panel(title=f"π_HL: {high}", curves=tuple(curves))


def _table(high: str, by_delay: dict[str, Any]) -> Table:
    rows = [
        (
            seconds(delay),
            seconds(interval),
            cell(found),
            str(found["n"]),
            f"{found['steps']:.0f}",
            f"{found['decisions']:.0f}",
        )
        for delay, swept in by_delay.items()
        for interval, found in swept.items()
    ]
    columns = ("answers after (s)", "asked every (s)", "success (95 %)", "n", "steps", "queries")
    return Table(title=f"High level: {high}", columns=columns, rows=tuple(rows))


def seconds(steps: str) -> str:
    """Control steps as people read them."""
    return f"{int(steps) / HZ:.1f}"
