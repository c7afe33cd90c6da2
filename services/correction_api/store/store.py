"""The store: one file, one writer, many readers, and what they are used for."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from services.correction_api.store.engine import open_engine, upgrade
from services.correction_api.store.episodes import Episodes
from services.correction_api.store.lessons import Lessons
from services.correction_api.store.log import Log
from services.correction_api.store.parcels import Parcels
from services.correction_api.store.rulings import Rulings
from services.correction_api.store.writer import Writer


class Store(NamedTuple):
    """See the class of each."""

    writer: Writer
    log: Log
    parcels: Parcels
    episodes: Episodes
    lessons: Lessons
    rulings: Rulings


@contextmanager
def open_store(database: Path, outbox_key: Callable[[str], str]) -> Iterator[Store]:
    """The store in `database`, made when there is none, until the context ends.

    outbox_key: at which key the learner takes a "correction", a "receipt" or a "ruling".
    """
    database.parent.mkdir(parents=True, exist_ok=True)
    writing = open_engine(database, begin="BEGIN IMMEDIATE", size=1)
    upgrade(writing)
    readers = open_engine(database)
    writer = Writer(writing)
    try:
        yield Store(
            writer,
            Log(writer, readers, outbox_key),
            Parcels(writer, readers),
            Episodes(writer, readers),
            Lessons(writer, readers),
            Rulings(writer, readers, outbox_key),
        )
    finally:
        writer.close()
        readers.dispose()
        writing.dispose()
