"""What the learner told of corrections: which version learned each, or that it was held out."""

from concurrent.futures import Future

from sqlalchemy import Connection, Engine, select
from sqlalchemy.dialects.sqlite import insert

from services.correction_api.store.log import Entry, Status, find_entry
from services.correction_api.store.tables import corrections, learned
from services.correction_api.store.writer import Writer
from shared.messages.correction import LEARNABLE
from shared.messages.learned import LearnedAnswer


class Lessons:
    """Kept beside the log, which is never rewritten."""

    def __init__(self, writer: Writer, readers: Engine) -> None:
        self._writer, self._readers = writer, readers

    def open(self, after: int, limit: int) -> dict[int, str]:
        """Up to `limit` corrections that may be learned and are not yet, by their sequence numbers.

        after: the sequence number to begin behind.
        """
        query = (
            select(corrections.c.sequence, corrections.c.id)
            .outerjoin(learned, learned.c.correction == corrections.c.id)
            .where(
                corrections.c.sequence > after,
                corrections.c.kind.in_(LEARNABLE),
                corrections.c.status.in_((Status.IN_FORCE, Status.KEPT)),
                learned.c.version.is_(None),
            )
            .order_by(corrections.c.sequence)
            .limit(limit)
        )
        with self._readers.connect() as connection:
            return {row.sequence: row.id for row in connection.execute(query)}

    def keep(self, answer: LearnedAnswer) -> Future[list[Entry]]:
        """Keep what the learner told; the entries of which something new is known."""
        told: dict[str, str | None] = dict.fromkeys(answer.held_out)
        told |= {name: str(version) for name, version in answer.learned.items()}

        def work(connection: Connection) -> list[Entry]:
            changed = []
            for name, version in told.items():
                before = find_entry(connection, name)
                if before is None or _same(before, version):
                    continue
                row = insert(learned).values(correction=name, version=version)
                row = row.on_conflict_do_update(["correction"], set_={"version": version})
                connection.execute(row)
                changed.append(find_entry(connection, name) or before)
            return changed

        return self._writer.submit(work)


def _same(entry: Entry, version: str | None) -> bool:
    known = str(entry.learned_in) if entry.learned_in else None
    return known == version and (version is not None or entry.held_out)
