"""`hld evaluate`: evaluate a high level and write the figures as JSON and as a table."""

import json
import os
import shlex
import sys
from contextlib import closing
from pathlib import Path
from typing import Annotated, Any, Optional

import typer
from rich.console import Console
from rich.table import Table

from shared.config import exit_misconfigured, load_or_exit, make_folder
from shared.errors import HldError
from shared.progress import Bars
from shared.rollout.settings import RolloutSettings
from shared.service import die_with_supervisor, interrupt_at_sigterm, run_command

INTERRUPTED = 130


def main(
    high_level: Annotated[
        str, typer.Option(help="base, oracle, a version such as 1.2, or a checkpoint folder")
    ] = "base",
    task: Annotated[
        Optional[list[str]],
        typer.Option("--task", help="one or, with commas or repeated, several in turn; all"),
    ] = None,
    seeds: Annotated[str, typer.Option(help="A:B, from the first evaluation seed")] = "0:60",
    site: Annotated[str, typer.Option(help="settings file of the cell")] = "far",
    skills: Annotated[
        Optional[int], typer.Option(min=1, help="how many the prompts take; as the task likes")
    ] = None,
    low_level: Annotated[str, typer.Option(help="checkpoint folder; the bundled one")] = "",
    data: Annotated[Path, typer.Option(help="the run whose versions are meant")] = Path("runs/up"),
    report: Annotated[
        Optional[Path], typer.Option(dir_okay=False, help="write the figures here, as JSON")
    ] = None,
    processes: Annotated[int, typer.Option(min=0, help="0: one a core")] = 0,
    set_: Annotated[
        Optional[list[str]], typer.Option("--set", help="KEY=VALUE of the rollout")
    ] = None,
) -> None:
    """Success with n and 95 % intervals by task and by skill, and what went wrong first.

    Without corrections, on seeds that no correction came from; each seed is one episode. Ctrl-C
    stops; the same command with the same --report goes on.
    """
    from shared.evaluation.plan import Plan, find_high_level, parse_seeds

    settings: dict[str, Any] = {"site": site, "low_level": low_level, "skills": skills}
    if task:
        settings["tasks"] = tuple(name.strip() for text in task for name in text.split(","))
    settings["rollout"] = load_or_exit(RolloutSettings, "rollout", sets=set_ or ())
    try:
        settings["high_level"] = find_high_level(high_level, data)
        plan = Plan(**settings, seeds=parse_seeds(seeds))
        plan.check()
        if report:
            make_folder(report.parent)
    except HldError as error:
        exit_misconfigured("evaluate", error)
    die_with_supervisor()
    interrupt_at_sigterm()
    try:
        _evaluate(plan, high_level, report, processes)
    except KeyboardInterrupt:
        again = "; the same command goes on" if report else ""
        print(f"evaluate: stopped{again}", file=sys.stderr)
        raise typer.Exit(INTERRUPTED) from None
    except HldError as error:
        print(f"evaluate: {error}", file=sys.stderr)
        raise typer.Exit(1) from None


def _evaluate(plan: Any, high_level: str, file: Path | None, processes: int) -> None:
    from shared.evaluation.evaluate import evaluate
    from shared.evaluation.pool import Pool
    from shared.evaluation.summary import report

    kept = file.with_suffix(".rows.jsonl") if file else None
    cases = len(plan.cases())
    console = Console()
    with closing(Bars(console)) as bars, Pool(min(processes or os.cpu_count() or 1, cases)) as pool:
        tell, rows = bars(f"{high_level} at {plan.site}", cases), []
        for row in evaluate(plan, pool, kept):
            rows.append(row)
            tell()
    content = report(plan, rows, high_level, shlex.join(["hld", "evaluate", *sys.argv[1:]]))
    if file:
        file.write_text(json.dumps(content, indent=2, ensure_ascii=False) + "\n")
    console.print(_table(content))


def _table(content: dict[str, Any]) -> Table:
    table = Table("", "success", "n", "95 % interval", "steps", "decisions")
    for name, figures in {**content["tasks"], "all": content}.items():
        table.add_row(name, *_rate(figures), f"{figures['decisions']:.0f}")
    table.add_section()
    for name, figures in content["skills"].items():
        table.add_row(name, *_rate(figures))
    if content["failures"]:
        table.add_section()
        for name, count in content["failures"].items():
            table.add_row(f"first: {name}", "", str(count))
    return table


def _rate(figures: dict[str, Any]) -> tuple[str, ...]:
    low, high = figures["interval"]
    rate = (f"{figures['success']:.2f}", str(figures["n"]), f"{low:.2f} to {high:.2f}")
    return (*rate, "" if figures["steps"] is None else f"{figures['steps']:.0f}")


if __name__ == "__main__":
    run_command(main)
