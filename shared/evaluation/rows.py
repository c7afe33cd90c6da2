"""Rows on the disk: what was measured is kept as it comes, and not measured again."""

import itertools
from collections.abc import Callable, Hashable, Iterator, Sequence
from pathlib import Path
from typing import Generic, TypeVar

from pydantic import BaseModel, ValidationError

from shared.config import Settings
from shared.evaluation.pool import Pool, Worker

R = TypeVar("R", bound=BaseModel)
P = TypeVar("P", bound=Settings)
Job = TypeVar("Job", bound=Hashable)


class Rows(Generic[R]):
    """A file with a row a line, and beside it a note of what the rows hang on.

    done: the rows that are there. Rows under another note are no use here and are moved aside, as
    NAME.old-1.jsonl; a last line that was half written is dropped.
    """

    def __init__(self, file: Path, kind: type[R], note: str) -> None:
        self._file, self._kind = file, kind
        self.done: list[R] = []
        file.parent.mkdir(parents=True, exist_ok=True)
        beside = file.with_suffix(".note.json")
        if beside.exists() and beside.read_text() == note:
            self.done = self._read()
        elif file.exists() and file.stat().st_size:
            file.replace(_free(file))
        file.write_text("".join(f"{row.model_dump_json()}\n" for row in self.done))
        beside.write_text(note)

    def add(self, row: R) -> None:
        """Keep one more."""
        self.done.append(row)
        with self._file.open("a") as file:
            file.write(f"{row.model_dump_json()}\n")

    def _read(self) -> list[R]:
        rows = []
        for line in self._file.read_text().splitlines() if self._file.exists() else ():
            try:
                rows.append(self._kind.model_validate_json(line))
            except ValidationError:
                break
        return rows


def _free(file: Path) -> Path:
    """Where old rows can be kept."""
    names = (file.with_suffix(f".old-{number}.jsonl") for number in itertools.count(1))
    return next(name for name in names if not name.exists())


def measure(
    pool: Pool,
    make: Callable[[P], Worker[Job, R]],
    plan: P,
    jobs: Sequence[Job],
    job_of: Callable[[R], Job],
    rows: Rows[R] | None = None,
) -> Iterator[R]:
    """A row for each job, those that are there first; the others as they are finished, and kept.

    job_of: the job that a row came from.
    """
    wanted = set(jobs)
    done = {job_of(row): row for row in (rows.done if rows else ())}
    found = [row for job, row in done.items() if job in wanted]
    yield from found
    missing = [job for job in jobs if job not in done]
    for row in pool.work(make, plan, missing):
        if rows:
            rows.add(row)
        yield row
