"""Kept: opens what a learner keeps of a run, for the commands that look at it or add to it."""

import json
from pathlib import Path
from typing import Annotated, Any, Optional

import typer

from services.learner.build import STORE_FILE
from services.learner.store.sql import SqlStore, sqlite_url
from shared.config import exit_misconfigured
from shared.errors import ConfigError

Data = Annotated[Path, typer.Option(help="the run, of `hld up` or of a learner")]
Report = Annotated[
    Optional[Path], typer.Option(dir_okay=False, help="write the same here, as JSON")
]


def find_folder(data: Path, command: str) -> Path:
    """The learner's folder of a run.

    Exits where there is none, naming the places that were looked at.
    """
    places = (data / "learner", data)
    found = next((place for place in places if (place / STORE_FILE).is_file()), None)
    if found is None:
        looked = " and ".join(str(place / STORE_FILE) for place in places)
        exit_misconfigured(command, ConfigError(f"no store of a learner: looked at {looked}"))
    return found


def open_store(data: Path, command: str) -> SqlStore:
    """The store of a run, beside a learner that may be running; exits where there is none."""
    folder = find_folder(data, command)
    return SqlStore(sqlite_url((folder / STORE_FILE).absolute()))


def write_report(report: Path | None, content: dict[str, Any]) -> None:
    """Write a report as JSON, if one is wanted."""
    if report:
        report.parent.mkdir(parents=True, exist_ok=True)
        report.write_text(json.dumps(content, indent=2, ensure_ascii=False) + "\n")
