"""`hld policy`: which versions a learner made, from what, what became of its other rounds; and what
people decide about them.

Opens the SQLite store beside a learner that may be running. What is decided is kept there, and done
by the learner: it alone makes versions.
"""

import json
import sys
import time
from collections.abc import Mapping, Sequence
from contextlib import closing
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Any

import typer
from pydantic import ValidationError
from rich import box
from rich.console import Console
from rich.table import Table

from services.learner.descent import Descent, descents, tell
from services.learner.kept import Data, Report, open_store, write_report
from services.learner.rulings import promotable
from services.learner.store.store import Answer, PolicyRecord, Round, RoundState, Store
from shared.config import exit_misconfigured
from shared.errors import ConfigError, RefusedError
from shared.messages.message import new_id
from shared.messages.ruling import Ruling, Verb
from shared.service import run_app

SCHEMA = 3
AUTHOR = "operator"
ANSWER_S = 5.0  # Ten looks of a learner.
app = typer.Typer(add_completion=False, no_args_is_help=True)


@app.callback()
def _policy() -> None:
    """Versions of the high level that a learner keeps."""


@app.command("list")
def list_versions(data: Data = Path("runs/up"), report: Report = None) -> None:
    """All rounds: what each was made from, what the gate said, and the version that it made."""
    with closing(open_store(data, "policy")) as store:
        versions, rounds, answers = store.versions(), store.rounds(), store.answers()
    came_of = descents(versions, rounds, answers)
    content = {
        "schema": SCHEMA,
        "versions": _told(versions, came_of),
        "rounds": _ended(rounds),
        "rulings": [answer.model_dump(mode="json") for answer in answers],
    }
    write_report(report, content)
    console = Console()
    console.print(_table(versions, rounds, came_of))
    for round_ in rounds:
        if told := round_.reason or round_.figures.get("unjudged"):
            console.print(f"round {round_.number}: {told}", markup=False)
    for answer in answers:
        if answer.ruling.verb in (Verb.PROMOTE, Verb.ROLLBACK):
            console.print(_ruled(answer), markup=False)


@app.command()
def show(
    number: Annotated[int, typer.Argument(min=0, help="the second half of a version: 2 of 1.2")],
    data: Data = Path("runs/up"),
    report: Report = None,
) -> None:
    """One version: what it came of, the round that made its weights, bank and tensors."""
    with closing(open_store(data, "policy")) as store:
        versions, rounds, answers = store.versions(), store.rounds(), store.answers()
    if number >= len(versions):
        known = f"there are 0 to {len(versions) - 1}" if versions else "there is none yet"
        exit_misconfigured("policy", ConfigError(f"no version {number} in {data}; {known}"))
    came_of = descents(versions, rounds, answers)[number]
    content = {"schema": SCHEMA, **detail(versions[number], came_of)}
    write_report(report, content)
    Console().print_json(json.dumps(content, ensure_ascii=False))


def detail(version: PolicyRecord, came_of: Descent) -> dict[str, Any]:
    """What is known of a version; `round` made its weights, None: the store began with them."""
    round_, again, ruling = came_of
    return {
        "number": version.number,
        "epoch": version.epoch,
        "created": _when(version.created_ns),
        "came_of": list(tell(came_of)),
        "round": round_.model_dump(mode="json") if round_ else None,
        "robots": list(version.robots),
        "again": again,
        "ruling": ruling.model_dump(mode="json") if ruling else None,
        "low_level_sha256": version.low_level_sha256,
        "bank": list(version.bank),
        "settings": version.settings,
        "tensors": [
            {"name": ref.name, "sha256": ref.sha256, "size_bytes": ref.size_bytes}
            for ref in version.tensors
        ],
    }


@app.command()
def promote(
    number: Annotated[int, typer.Argument(min=1, help="the round whose candidate was refused")],
    reason: Annotated[str, typer.Option(help="why, for the record")],
    data: Data = Path("runs/up"),
    author: Annotated[str, typer.Option(help="who decides")] = AUTHOR,
) -> None:
    """Put what a round made in force, although the gate refused it."""
    _decide(data, Verb.PROMOTE, author, reason, round=number)


@app.command()
def rollback(
    number: Annotated[int, typer.Argument(min=0, help="the version whose weights are wanted")],
    reason: Annotated[str, typer.Option(help="why, for the record")],
    data: Data = Path("runs/up"),
    author: Annotated[str, typer.Option(help="who decides")] = AUTHOR,
) -> None:
    """Put the weights of an earlier version in force again, under a new number."""
    _decide(data, Verb.ROLLBACK, author, reason, version=number)


def _decide(data: Path, verb: Verb, author: str, reason: str, **about: int) -> None:
    """Keep a ruling, and tell what the learner made of it, if one is at work."""
    now_ns = time.time_ns()
    try:
        ruling = Ruling(
            id=new_id("rule"), verb=verb, author=author, reason=reason, created_ns=now_ns, **about
        )
    except ValidationError as error:
        exit_misconfigured("policy", ConfigError(error.errors()[0]["msg"]))
    with closing(open_store(data, "policy")) as store:
        _check_known(store, ruling)
        store.add(ruling, now_ns)
        answer = _answered(store, ruling.id)
    if answer is None:
        print("kept; no learner is at work on this store, the next one does it", flush=True)
    elif answer.made is None:
        print(f"policy: refused: {answer.reason}", file=sys.stderr)
        raise typer.Exit(1)
    else:
        print(f"version {answer.made} is in force", flush=True)


def _check_known(store: Store, ruling: Ruling) -> None:
    """Refuse at once what no learner could do."""
    rollback = ruling.verb is Verb.ROLLBACK
    wanted = ruling.version if rollback else ruling.round
    known = [one.number for one in (store.versions() if rollback else store.rounds())]
    if wanted not in known:
        what = "version" if rollback else "round"
        there = f"there are {', '.join(map(str, known))}" if known else "there is none yet"
        exit_misconfigured("policy", ConfigError(f"no {what} {wanted}; {there}"))
    if not rollback:
        try:
            promotable(next(one for one in store.rounds() if one.number == wanted))
        except RefusedError as error:
            exit_misconfigured("policy", error)


def _answered(store: Store, ruling: str) -> Answer | None:
    """What a learner made of a ruling; None where none did in time."""
    deadline = time.monotonic() + ANSWER_S
    while time.monotonic() < deadline:
        found = next(one for one in store.answers() if one.ruling.id == ruling)
        if found.answered_ns is not None:
            return found
        time.sleep(0.1)
    return None


def _told(versions: Sequence[PolicyRecord], came_of: Mapping[int, Descent]) -> list[dict[str, Any]]:
    return [
        {
            "number": version.number,
            "epoch": version.epoch,
            "created": _when(version.created_ns),
            "round": made_by.number if (made_by := came_of[version.number].round) else None,
            "in_force": version.number == in_force(versions),
            "robots": list(version.robots),
            "again": came_of[version.number].again,
            "ruling": version.ruling,
        }
        for version in versions
    ]


def in_force(versions: Sequence[PolicyRecord]) -> int | None:
    """The number of the newest version that all robots run."""
    return next((one.number for one in reversed(versions) if not one.robots), None)


def _ended(rounds: Sequence[Round]) -> list[dict[str, Any]]:
    return [
        round_.model_dump(mode="json", exclude={"candidate": True, "manifest": _LONG})
        for round_ in rounds
    ]


def _ruled(answer: Answer) -> str:
    ruling = answer.ruling
    about = f"round {ruling.round}" if ruling.round is not None else f"version {ruling.version}"
    outcome = f"refused: {answer.reason}" if answer.reason else f"made version {answer.made}"
    if answer.answered_ns is None:
        outcome = "not done yet"
    return f"{ruling.author}, {ruling.verb} {about} ({ruling.reason}): {outcome}"


_LONG = {"settings", "excluded"}


def _table(
    versions: Sequence[PolicyRecord], rounds: Sequence[Round], came_of: Mapping[int, Descent]
) -> Table:
    """It fits into 80 columns; times, labels and the rest stand in the report."""
    table = Table(box=box.SIMPLE)
    for name in ("version", "round", "episodes", "corrections", "held out", "retained"):
        table.add_column(name, no_wrap=True)
    table.add_column("outcome")
    for version in versions:
        if version.number not in {round_.made for round_ in rounds}:
            outcome = "in force" if version.number == in_force(versions) else "replaced"
            origin = _origin(came_of[version.number])
            table.add_row(f"{version.epoch}.{version.number}", *[""] * 5, f"{origin}{outcome}")
    for round_ in rounds:
        table.add_row(*_row(round_, versions))
    return table


def _origin(came_of: Descent) -> str:
    """Of a version that no round put in force."""
    round_, again, ruling = came_of
    by = f" by {ruling.author}" if ruling else ""
    if again is not None:
        return f"{again} again{by}, "
    return f"round {round_.number}{by}, " if round_ else ""


def _row(round_: Round, versions: Sequence[PolicyRecord]) -> list[str]:
    figures = round_.figures
    outcome = str(round_.state)
    if round_.state is RoundState.PASSED:
        outcome = "in force" if round_.made == in_force(versions) else "replaced"
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


def _when(time_ns: int) -> str:
    return datetime.fromtimestamp(time_ns / 1e9, UTC).isoformat(sep=" ", timespec="seconds")[:19]


if __name__ == "__main__":
    run_app(app)
