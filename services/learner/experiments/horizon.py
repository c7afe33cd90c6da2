"""How does success fall as tasks grow longer, and is it (1-ε)^T?"""

from collections.abc import Sequence
from typing import Any

from services.learner.experiments.bench import Bench, slug
from services.learner.experiments.findings import Curve, Findings, Panel, Plot, Table, cell, curve
from shared.evaluation.attempts import Row
from shared.evaluation.plan import ORACLE
from shared.intervals import rate

LENGTHS = (2, 4, 6, 8, 10, 12, 14, 16)
SMALL_LENGTHS = (6, 8)


def run(bench: Bench) -> Findings:
    """Each task in each of its lengths, under the oracle and under the learned high level."""
    highs = (ORACLE, bench.high_level)
    figures = {task: {high: _grow(bench, task, high) for high in highs} for task in bench.tasks()}
    return Findings(
        title="Success over the horizon",
        method=(
            "T is the number of skills that a prompt takes, a pick and a put for each thing. Each "
            "length is tried on the same scenes under each high level, with the same low level.",
            "ε is the share of skill calls in these same episodes that failed, up to the first "
            "that did in each: not achieved, or not right to say at some decision while in force. "
            "(1-ε)^T is what success would be if each call had to succeed at the first try, "
            "independently of the others.",
        ),
        figures=figures,
        tables=tuple(_table(task, by_high) for task, by_high in figures.items()),
        plots=(
            Plot(
                name="horizon",
                title=f"Success over the horizon, {bench.site}",
                x_label="T, skills that the prompt takes",
                panels=tuple(_panel(task, by_high) for task, by_high in figures.items()),
            ),
        ),
        notes=(
            "Success can lie above (1-ε)^T, since a call that failed may be made again; and below "
            "it, where calls that fail come together.",
            "Intervals of rates are Wilson's; that of ε takes calls as independent, although "
            "several come from one episode, and the band of (1-ε)^T is what it gives at its ends.",
        ),
    )


def _grow(bench: Bench, task: str, high: str) -> dict[str, Any]:
    """Success by length, and ε over all lengths."""
    lengths = SMALL_LENGTHS if bench.small else LENGTHS
    rows = {
        length: bench.episodes(
            f"{slug(high)}-{task}-{length}",
            bench.plan(high_level=high, tasks=(task,), skills=length),
        )
        for length in lengths
        if task in bench.tasks(length)
    }
    epsilon = fallibility([row for some in rows.values() for row in some])
    return {
        "epsilon": epsilon,
        "lengths": {
            length: {
                **rate([row.success for row in some]),
                "epsilon": fallibility(some),
                "expected": chain(epsilon, length),
            }
            for length, some in rows.items()
        },
    }


def fallibility(rows: Sequence[Row]) -> dict[str, Any]:
    """ε: the share of skill calls that were not flawless, with n and interval.

    Of each episode the calls up to the first that failed: what comes after it tells how a lost
    episode goes on, and not how one is lost. To wait is a call only where it was wrong.
    """
    failed = rate([failed for row in rows for failed in _until_failed(row)])
    return {"value": failed["success"], "n": failed["n"], "interval": failed["interval"]}


def _until_failed(row: Row) -> list[bool]:
    """Of each call whether it failed, up to the first that did."""
    calls = [not one.flawless for one in row.attempts if one.skill or one.wrong]
    return calls[: calls.index(True) + 1] if True in calls else calls


def chain(epsilon: dict[str, Any], length: int) -> dict[str, Any]:
    """(1-ε)^T, and what it is at the ends of ε's interval."""
    low, high = epsilon["interval"]
    return {
        "value": round((1 - epsilon["value"]) ** length, 4),
        "interval": [round((1 - high) ** length, 4), round((1 - low) ** length, 4)],
    }


def _panel(task: str, by_high: dict[str, Any]) -> Panel:
    curves: list[Curve] = []
    for high, found in by_high.items():
        lengths = found["lengths"]
        expected = [row["expected"] for row in lengths.values()]
        curves += [
            curve(high, {float(length): row for length, row in lengths.items()}),
            Curve(
                label=f"(1-ε)^T, ε = {found['epsilon']['value']:.3f}",
                x=tuple(float(length) for length in lengths),
                y=tuple(row["value"] for row in expected),
                low=tuple(row["interval"][0] for row in expected),
                high=tuple(row["interval"][1] for row in expected),
                dashed=True,
            ),
        ]
    return Panel(title=task, curves=tuple(curves))


def _table(task: str, by_high: dict[str, Any]) -> Table:
    rows = []
    for high, found in by_high.items():
        for length, row in found["lengths"].items():
            expected = row["expected"]
            low, top = expected["interval"]
            rows.append(
                (
                    high,
                    str(length),
                    cell(row),
                    str(row["n"]),
                    f"{row['epsilon']['value']:.3f} of {row['epsilon']['n']}",
                    f"{expected['value']:.2f} ({low:.2f} to {top:.2f})",
                )
            )
    columns = ("π_HL", "T", "success (95 %)", "n", "ε in these episodes", "(1-ε)^T, ε of all T")
    return Table(title=task, columns=columns, rows=tuple(rows))
