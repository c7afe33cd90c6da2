"""The outbox to the learner, in the same file as the log, so that one commit covers both."""

from sqlalchemy import Connection, Engine, delete, func, insert, select, update

from services.correction_api.store.tables import outbox
from services.correction_api.store.writer import Writer
from shared.wire.outbox import Parcel


class Parcels:
    """What the learner does not have yet; the `Courier` takes it away, in order."""

    def __init__(self, writer: Writer, readers: Engine) -> None:
        self._writer, self._readers = writer, readers

    def pending(self, limit: int = 100) -> list[Parcel]:
        """The oldest parcels that wait, at most `limit`."""
        query = (
            select(outbox)
            .where(outbox.c.refused.is_(None))
            .order_by(outbox.c.sequence)
            .limit(limit)
        )
        with self._readers.connect() as connection:
            rows = connection.execute(query).all()
        return [Parcel(row.id, row.key, row.payload, row.sequence) for row in rows]

    def done(self, id: str) -> None:
        """The learner has it."""
        self._writer.submit(
            lambda connection: connection.execute(delete(outbox).where(outbox.c.id == id))
        ).result()

    def refuse(self, id: str, reason: str) -> None:
        """The learner said no: kept aside with the reason, and not sent again."""
        self._writer.submit(
            lambda connection: connection.execute(
                update(outbox).where(outbox.c.id == id).values(refused=reason)
            )
        ).result()

    def __len__(self) -> int:
        """How many wait; refused ones don't count."""
        query = select(func.count()).select_from(outbox).where(outbox.c.refused.is_(None))
        with self._readers.connect() as connection:
            return connection.execute(query).scalar_one()


def send(connection: Connection, id: str, key: str, payload: bytes) -> None:
    """Post a parcel within somebody else's transaction."""
    connection.execute(insert(outbox).values(id=id, key=key, payload=payload))
