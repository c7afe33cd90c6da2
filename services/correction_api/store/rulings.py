"""Rulings about versions: kept with their parcel to the learner in one commit, as corrections."""

from collections.abc import Callable
from concurrent.futures import Future

from sqlalchemy import Connection, Engine, insert, select

from services.correction_api.store.parcels import send
from services.correction_api.store.tables import outbox, rulings
from services.correction_api.store.writer import Writer
from shared.messages.ruling import Ruling


class Rulings:
    """What people decided here."""

    def __init__(self, writer: Writer, readers: Engine, outbox_key: Callable[[str], str]) -> None:
        self._writer, self._readers, self._key = writer, readers, outbox_key("ruling")
        self._posted: Callable[[], None] = lambda: None

    def on_post(self, posted: Callable[[], None]) -> None:
        """Have `posted` called after each commit, in the writer's thread."""
        self._posted = posted

    def append(self, ruling: Ruling) -> Future[Ruling]:
        """Keep a ruling, and post it to the learner; the one of its id that is there wins."""

        def work(connection: Connection) -> Ruling:
            query = select(rulings.c.message).where(rulings.c.id == ruling.id)
            if held := connection.scalar(query):
                return Ruling.model_validate_json(held)
            text = ruling.model_dump_json()
            connection.execute(insert(rulings).values(id=ruling.id, message=text))
            send(connection, f"ruling/{ruling.id}", self._key, text.encode())
            return ruling

        future = self._writer.submit(work)
        future.add_done_callback(lambda _: self._posted())
        return future

    def page(self, limit: int) -> list[tuple[Ruling, str | None]]:
        """The last ones, the newest first, each with what is still in its way to the learner:
        None where the learner has it, "" where it waits, or why the learner wouldn't take it."""
        query = (
            select(rulings.c.message, outbox.c.id, outbox.c.refused)
            .select_from(rulings.outerjoin(outbox, outbox.c.id == "ruling/" + rulings.c.id))
            .order_by(rulings.c.sequence.desc())
            .limit(limit)
        )
        with self._readers.connect() as connection:
            rows = connection.execute(query).all()
        return [
            (Ruling.model_validate_json(text), None if waits is None else refused or "")
            for text, waits, refused in rows
        ]
