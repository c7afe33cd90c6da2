"""`hld policy`: which versions a learner made, from what, and what became of its other rounds.

Opens the SQLite store beside a learner that may be running, and adds nothing to it.
"""

import json
from collections.abc import Sequence
from contextlib import closing
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Any

import typer
from rich import box
from rich.console import Console
from rich.table import Table

from services.learner.kept import Data, Report, open_store, write_report
from services.learner.store.store import PolicyRecord, Round, RoundState
from shared.config import exit_misconfigured
from shared.errors import ConfigError
from shared.service import run_app

SCHEMA = 1
app = typer.Typer(add_completion=False, no_args_is_help=True)


@app.callback()
def _policy() -> None:
    """Versions of the high level that a learner keeps."""


@app.command("list")
def list_versions(data: Data = Path("runs/up"), report: Report = None) -> None:
    """All rounds: what each was made from, what the gate said, and the version that it made."""
    with closing(open_store(data, "policy")) as store:
        versions, rounds = store.versions(), store.rounds()
    content = {"schema": SCHEMA, "versions": _told(versions, rounds), "rounds": _ended(rounds)}
    write_report(report, content)
    console = Console()
    console.print(_table(versions, rounds))
    for round_ in rounds:
        if round_.reason:
            console.print(f"round {round_.number}: {round_.reason}", markup=False)


@app.command()
def show(
    number: Annotated[int, typer.Argument(min=0, help="the second half of a version: 2 of 1.2")],
    data: Data = Path("runs/up"),
    report: Report = None,
) -> None:
    """One version: its round with manifest, seed, settings and figures, bank and tensors."""
    with closing(open_store(data, "policy")) as store:
        versions, rounds = store.versions(), store.rounds()
    if number >= len(versions):
        known = f"there are 0 to {len(versions) - 1}" if versions else "there is none yet"
        exit_misconfigured("policy", ConfigError(f"no version {number} in {data}; {known}"))
    content = {"schema": SCHEMA, **detail(versions[number], rounds)}
    write_report(report, content)
    Console().print_json(json.dumps(content, ensure_ascii=False))


def detail(version: PolicyRecord, rounds: Sequence[Round]) -> dict[str, Any]:
    """What is known of a version; `round` is None for the one that a store begins with."""
    made_by = _made_by(version, rounds)
    return {
        "number": version.number,
        "epoch": version.epoch,
        "created": _when(version.created_ns),
        "round": made_by.model_dump(mode="json") if made_by else None,
        "low_level_sha256": version.low_level_sha256,
        "bank": list(version.bank),
        "settings": version.settings,
        "tensors": [
            {"name": ref.name, "sha256": ref.sha256, "size_bytes": ref.size_bytes}
            for ref in version.tensors
        ],
    }


def _told(versions: Sequence[PolicyRecord], rounds: Sequence[Round]) -> list[dict[str, Any]]:
    return [
        {
            "number": version.number,
            "epoch": version.epoch,
            "created": _when(version.created_ns),
            "round": made_by.number if (made_by := _made_by(version, rounds)) else None,
            "in_force": version is versions[-1],
        }
        for version in versions
    ]


def _ended(rounds: Sequence[Round]) -> list[dict[str, Any]]:
    return [
        round_.model_dump(mode="json", exclude={"manifest": {"settings", "excluded"}})
        for round_ in rounds
    ]


def _table(versions: Sequence[PolicyRecord], rounds: Sequence[Round]) -> Table:
    """It fits into 80 columns; times, labels and the rest stand in the report."""
    table = Table(box=box.SIMPLE)
    for name in ("version", "round", "episodes", "corrections", "held out", "retained"):
        table.add_column(name, no_wrap=True)
    table.add_column("outcome")
    for version in versions:
        if _made_by(version, rounds) is None:
            outcome = "in force" if version is versions[-1] else "replaced"
            table.add_row(f"{version.epoch}.{version.number}", *[""] * 5, outcome)
    for round_ in rounds:
        table.add_row(*_row(round_, versions))
    return table


def _row(round_: Round, versions: Sequence[PolicyRecord]) -> list[str]:
    figures = round_.figures
    outcome = str(round_.state)
    if round_.state is RoundState.PASSED:
        outcome = "in force" if round_.made == versions[-1].number else "replaced"
    return [
        f"{round_.epoch}.{round_.made}" if round_.made is not None else "",
        str(round_.number),
        str(round_.manifest.episodes),
        str(round_.manifest.corrections),
        _change(figures.get("before"), figures.get("after")),
        _change(figures.get("retained_before"), figures.get("retained_after")),
        outcome,
    ]


def _change(before: float | None, after: float | None) -> str:
    return "" if before is None or after is None else f"{before:.2f} → {after:.2f}"


def _made_by(version: PolicyRecord, rounds: Sequence[Round]) -> Round | None:
    return next((round_ for round_ in rounds if round_.made == version.number), None)


def _when(time_ns: int) -> str:
    return datetime.fromtimestamp(time_ns / 1e9, UTC).isoformat(sep=" ", timespec="seconds")[:19]


if __name__ == "__main__":
    run_app(app)
