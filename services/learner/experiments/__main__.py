"""`hld experiment`: measure, and write report.json, report.md and plots."""

import os
import shlex
import sys
from contextlib import closing
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Annotated, Optional

import typer
from rich.console import Console

from services.learner.experiments import report
from services.learner.experiments.bench import Bench, Scale
from services.learner.experiments.registry import EXPERIMENTS, experiment_named
from shared.config import exit_misconfigured, make_folder
from shared.errors import ConfigError, HldError
from shared.evaluation.plan import ORACLE, Plan, find_high_level, parse_seeds
from shared.evaluation.pool import Pool
from shared.policies.checkpoint import load_card
from shared.progress import Bars
from shared.service import interrupt_at_sigterm, run_command

INTERRUPTED = 130


def main(
    name: Annotated[str, typer.Argument(help=f"one of {', '.join(EXPERIMENTS)}")],
    out: Annotated[
        Optional[Path],
        typer.Option(file_okay=False, help="rows and report, resumed if there; runs/NAME"),
    ] = None,
    scale: Annotated[
        str,
        typer.Option(
            help="small: a minute, to try it; full: to learn; core, of dagger and baselines: less"
        ),
    ] = "full",
    seeds: Annotated[str, typer.Option(help="A:B, from the first evaluation seed")] = "",
    n: Annotated[
        Optional[int],
        typer.Option(min=1, help="short for --seeds 0:N; as many as the scale has"),
    ] = None,
    site: Annotated[
        str, typer.Option(help="settings file of the cell; lab, but for dagger far")
    ] = "",
    high_level: Annotated[
        str,
        typer.Option(
            help="base (the usual), a version, a folder; for horizon, dagger and the like"
        ),
    ] = "",
    low_level: Annotated[
        str, typer.Option(help="checkpoint folder; the bundled one; not for baselines")
    ] = "",
    baselines: Annotated[
        Optional[Path],
        typer.Option(file_okay=False, help="a run of the baselines, whose flat arm dagger tries"),
    ] = None,
    report_: Annotated[
        Optional[Path],
        typer.Option("--report", dir_okay=False, help="write report.json here, too"),
    ] = None,
    data: Annotated[Path, typer.Option(help="the run whose versions are meant")] = Path("runs/up"),
    processes: Annotated[int, typer.Option(min=0, help="0: one a core")] = 0,
) -> None:
    """Run an experiment and write its report into OUT.

    Ctrl-C stops; the same command goes on with what is missing.
    """
    out = out or Path("runs") / name
    try:
        experiment = experiment_named(name)
        some = experiment.scenes(scale)
        if n and seeds:
            raise ConfigError(f"--n {n} is short for --seeds 0:{n}: say one of the two")
        wanted = parse_seeds(seeds or f"0:{n or some}")
        experiment.accept(high_level, low_level, baselines)
        high_level = high_level or "base"
        learned = find_high_level(high_level, data) if experiment.learned else ORACLE
        site = site or experiment.site
        plan = Plan(high_level=learned, low_level=low_level, site=site, seeds=wanted)
        plan.check()
        make_folder(out)
        if report_:
            make_folder(report_.parent)
    except HldError as error:
        exit_misconfigured("experiment", error)
    about = {
        "experiment": name,
        "command": shlex.join(["hld", "experiment", *sys.argv[1:]]),
        "date": datetime.now(UTC).date().isoformat(),
        "scale": scale,
        "site": site,
        "seeds": f"{wanted[0]}:{wanted[1]}",
        "n": wanted[1] - wanted[0],
        "low_level_sha256": load_card(plan.low_level_folder()).tensors_sha256
        if experiment.low_level
        else None,
        "high_level": high_level if experiment.learned else None,
        "high_level_sha256": load_card(plan.high_level_folder()).tensors_sha256
        if plan.high_level != ORACLE
        else None,
    }
    os.environ["OMP_NUM_THREADS"] = "1"  # The processes share the cores.
    interrupt_at_sigterm()
    console = Console()
    try:
        with closing(Bars(console)) as bars, Pool(processes) as pool:
            size = Scale(scale)
            publish = partial(report.write, out, about=about)
            bench = Bench(
                out, pool, bars, wanted, size, site, learned, low_level, baselines, publish
            )
            findings = experiment.run(bench)
    except KeyboardInterrupt:
        console.print(f"stopped; the same command goes on in {out}", markup=False)
        raise typer.Exit(INTERRUPTED) from None
    except HldError as error:
        print(f"experiment: {error}", file=sys.stderr)
        raise typer.Exit(1) from None
    report.write(out, findings, about)
    if report_:
        report_.write_text((out / "report.json").read_text())
    console.print(f"report: {out / 'report.md'}", markup=False)


if __name__ == "__main__":
    run_command(main)
