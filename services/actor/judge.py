"""`hld evaluate`: evaluate a high level and write the figures as JSON and as a table."""

import json
import os
from pathlib import Path
from typing import Annotated, Any, Optional

import typer
from rich.console import Console
from rich.progress import track
from rich.table import Table

from shared.config import exit_misconfigured, load_or_exit
from shared.errors import HldError
from shared.rollout.settings import RolloutSettings
from shared.seeds import EVALUATION
from shared.service import die_with_supervisor


def main(
    high_level: Annotated[str, typer.Option(help="base, oracle, or a checkpoint folder")] = "base",
    tasks: Annotated[str, typer.Option(help="taken in turn")] = "sandwich,pack",
    site: Annotated[str, typer.Option(help="settings file of the cell")] = "workshop",
    episodes: Annotated[int, typer.Option(min=1, max=100_000)] = 60,
    first_seed: Annotated[
        int, typer.Option(help="evaluation seeds begin there")
    ] = EVALUATION.start,
    low_level: Annotated[str, typer.Option(help="checkpoint folder; the bundled one")] = "",
    report: Annotated[Optional[Path], typer.Option(help="write the figures here")] = None,
    processes: Annotated[int, typer.Option(min=0, help="0: one a core")] = 0,
    set_: Annotated[
        Optional[list[str]], typer.Option("--set", help="KEY=VALUE of the rollout")
    ] = None,
) -> None:
    """Success with n and a 95 % interval, on seeds that no correction came from."""
    from services.actor.evaluate import Plan, Row, check, evaluate, read_rows, summarize

    rollout = load_or_exit(RolloutSettings, "rollout", sets=set_ or ())
    plan = Plan(
        high_level,
        tuple(tasks.split(",")),
        site,
        episodes,
        rollout=rollout,
        low_level=low_level,
        first_seed=first_seed,
    )
    try:
        check(plan)
    except HldError as error:
        exit_misconfigured("evaluate", error)
    die_with_supervisor()
    kept = report.with_suffix(".rows.jsonl") if report else None
    done = _same_plan(kept, plan._asdict()) and read_rows(kept) if kept else []
    rows: list[Row] = []
    found = evaluate(plan, processes or os.cpu_count() or 1, done or [])
    for row in track(found, total=episodes, description=f"{high_level} at {site}"):
        rows.append(row)
        if kept and row not in (done or []):
            with kept.open("a") as file:
                file.write(json.dumps(row._asdict()) + "\n")
    summary = {
        "schema": 1,
        "high_level": high_level,
        "site": site,
        **summarize(rows),
    }
    if report:
        report.write_text(json.dumps(summary, indent=2) + "\n")
    Console().print(_table(summary))


def _same_plan(kept: Path, plan: dict[str, Any]) -> bool:
    """Rows of another plan are no use: what is there is cleared, and the plan noted beside."""
    note = kept.with_suffix(".plan.json")
    text = json.dumps({**plan, "rollout": plan["rollout"].model_dump(), "episodes": None})
    if note.exists() and note.read_text() == text:
        return True
    kept.parent.mkdir(parents=True, exist_ok=True)
    kept.unlink(missing_ok=True)
    note.write_text(text)
    return False


def _table(summary: dict[str, Any]) -> Table:
    table = Table("task", "success", "n", "95 % interval")
    rows = {**summary["tasks"], "all": summary}
    for name, rate in rows.items():
        low, high = rate["interval"]
        table.add_row(name, f"{rate['success']:.2f}", str(rate["n"]), f"{low:.2f} to {high:.2f}")
    return table


if __name__ == "__main__":
    typer.run(main)
