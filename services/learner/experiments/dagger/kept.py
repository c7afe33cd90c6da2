"""What came of each course and each arm of a training seed, in a file each, small enough to be
carried elsewhere.

A run takes hours, weights and stores are large, and what the report needs of them is little. So a
run that goes on in another place needs these files alone, and doesn't do again what is in them.
"""

import gzip
import zlib
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

from pydantic import BaseModel, ConfigDict, ValidationError

from services.learner.build import STORE_FILE
from services.learner.experiments.dagger.course import Effort
from services.learner.experiments.dagger.lessons import Taught
from shared.errors import HldError
from shared.evaluation.attempts import Attempt, Row

BySeed = list[list[Row]]
"""Rows by training seed; one alone where nothing was trained."""


class Pace(NamedTuple):
    """What people did in the rounds of one course; staleness: see `Course`, by round."""

    person: str
    seed: int
    efforts: tuple[Effort, ...]
    staleness: tuple[dict[str, int], ...]


class Outcomes(BaseModel):
    """What was found, without the attempts in the rows but the one that failed first.

    note: what it hangs on. rows: by the arm's name. lab: the same in the lab, of few arms.
    prompts: that were corrected. taught: what the arms learned from.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    note: str
    rows: dict[str, list[Row]]
    lab: dict[str, list[Row]] = {}
    paces: list[Pace] = []
    prompts: list[str] = []
    taught: list[Taught] = []


def joined(parts: Sequence[Outcomes]) -> Outcomes:
    """All of them as one, which hangs on nothing by itself."""
    return Outcomes(
        note="",
        rows={name: rows for part in parts for name, rows in part.rows.items()},
        lab={name: rows for part in parts for name, rows in part.lab.items()},
        paces=[pace for part in parts for pace in part.paces],
        prompts=[prompt for part in parts for prompt in part.prompts],
        taught=[taught for part in parts for taught in part.taught],
    )


class Archive:
    """The folder of these files."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def file(self, name: str) -> Path:
        """Where outcomes of this name lie."""
        return self._folder / f"{name}.json.gz"

    def has(self, name: str, note: str) -> bool:
        """Whether they are there.

        Raises:
            HldError: as `get`.
        """
        file = self.file(name)
        return file.exists() and bool(self._read(file, note))

    def get(self, name: str, note: str, make: Callable[[], Outcomes]) -> Outcomes:
        """Those that are there, else those that are made now and kept.

        Raises:
            HldError: what is there can't be read, or hangs on something else.
        """
        file = self.file(name)
        if file.exists():
            return self._read(file, note)
        made = make()
        self._folder.mkdir(parents=True, exist_ok=True)
        beside = file.with_name(f"unfinished-{file.name}")
        # No time in it: equal outcomes give equal files.
        beside.write_bytes(gzip.compress(made.model_dump_json().encode(), mtime=0))
        beside.replace(file)
        return made

    def _read(self, file: Path, note: str) -> Outcomes:
        try:
            found = Outcomes.model_validate_json(gzip.decompress(file.read_bytes()))
        except (OSError, EOFError, zlib.error, ValidationError) as error:
            raise HldError(f"{file} holds no outcomes ({error}): move it away") from None
        if found.note != note:
            raise _other(file)
        return found


def claim(folder: Path, note: str) -> None:
    """Begin in a folder, or go on there. note: what its contents hang on.

    Raises:
        HldError: what is there hangs on something else.
    """
    file = folder / "note.json"
    if (folder / STORE_FILE).exists() or file.exists():
        if not file.exists() or file.read_text() != note:
            raise _other(folder)
        return
    folder.mkdir(parents=True, exist_ok=True)
    beside = file.with_name("unfinished-note.json")
    beside.write_text(note)
    beside.replace(file)


def _other(what: Path) -> HldError:
    return HldError(
        f"{what} comes from other settings, scenes or policies than these: move it away, or name "
        "another --out"
    )


def bare(rows: list[Row]) -> list[Row]:
    """Without what was attempted in them, but for what went wrong first where one failed."""
    return [row.model_copy(update={"attempts": _failed(row)}) for row in rows]


def _failed(row: Row) -> tuple[Attempt, ...]:
    """The attempt under way when something went wrong first; none in a success."""
    step = row.failed_step
    under_way = [one for one in row.attempts if one.begin <= step]
    return tuple(under_way[-1:]) if not row.success and step >= 0 else ()
