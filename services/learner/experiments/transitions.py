"""When to go on to the next skill: by interval, by completion, or both; asked slowly or fast."""

from itertools import product
from typing import Any

from services.learner.experiments.bench import Bench, slug
from services.learner.experiments.findings import (
    Findings,
    Panel,
    Plot,
    Table,
    cell,
    curve,
    gap_cell,
)
from shared.evaluation.attempts import Row
from shared.evaluation.plan import ORACLE
from shared.evaluation.summary import summarize
from shared.intervals import mcnemar, paired_difference
from shared.rollout.settings import Replan

PACES = {
    "fast": {"latency_steps": 0, "decision_steps": 20},
    "slow": {"latency_steps": 50, "decision_steps": 100},
}
"""A fast π_HL answers at once and is asked every 0.4 s; a slow one takes 1 s, asked every 2 s,
so that a hand that is done can ask sooner."""
REFERENCE = Replan.INTERVAL


def run(bench: Bench) -> Findings:
    """Every way to go on, under both paces, for the oracle and the learned high level."""
    highs = (ORACLE, bench.high_level)
    rows = {
        (high, pace, way): bench.episodes(
            f"{slug(high)}-{pace}-{way}",
            bench.plan(high_level=high, rollout={**PACES[pace], "replan": way}),
        )
        for high, pace, way in product(highs, PACES, Replan)
    }
    figures: dict[str, Any] = {
        high: {
            pace: {
                str(way): {**summarize(rows[high, pace, way]), **_against(rows, high, pace, way)}
                for way in Replan
            }
            for pace in PACES
        }
        for high in highs
    }
    return Findings(
        title="Transitions: interval, completion, both",
        method=(
            "The high level is asked by interval, when the low level's classifier says that the "
            "command is achieved, or by both with a stuck timer. A fast one answers at once and is "
            "asked every 20 steps (0.4 s); a slow one answers after 50 steps (1 s) and is asked "
            "every 100 (2 s).",
            "The same scenes each time; differences from asking by interval are paired.",
        ),
        figures=figures,
        tables=tuple(_table(high, figures[high]) for high in highs),
        plots=(
            Plot(
                name="transitions",
                title=f"Transitions, {bench.site}",
                x_label="the high level is asked by",
                panels=tuple(
                    Panel(
                        title=f"π_HL: {high}",
                        curves=tuple(curve(pace, figures[high][pace]) for pace in PACES),
                    )
                    for high in highs
                ),
            ),
        ),
        notes=(
            "One training seed: this compares ways to run one pair of policies, and says nothing "
            "of others.",
            "p is McNemar's, exact, two-sided; intervals of differences are Newcombe's, for pairs.",
        ),
    )


def _against(
    rows: dict[tuple[str, str, Replan], list[Row]], high: str, pace: str, way: Replan
) -> dict[str, Any]:
    """How much better than by interval, on the same scenes."""
    if way is REFERENCE:
        return {}
    mine, other = ([row.success for row in rows[high, pace, one]] for one in (way, REFERENCE))
    gap = paired_difference(mine, other)
    return {
        "less_interval": {
            "difference": round(gap.value, 4),
            "interval": [round(gap.low, 4), round(gap.high, 4)],
            "p": round(mcnemar(mine, other), 4),
        }
    }


def _table(high: str, by_pace: dict[str, Any]) -> Table:
    rows = [
        (
            pace,
            way,
            cell(found),
            str(found["n"]),
            f"{found['steps']:.0f}",
            f"{found['decisions']:.0f}",
            gap_cell(found["less_interval"]) if "less_interval" in found else "",
            ", ".join(f"{name} {count}" for name, count in found["failures"].items()),
        )
        for pace, ways in by_pace.items()
        for way, found in ways.items()
    ]
    columns = (
        "π_HL is", "asked by", "success (95 %)", "n", "steps", "queries", "less interval",
        "failed first",
    )  # fmt: skip
    return Table(title=f"High level: {high}", columns=columns, rows=tuple(rows))
