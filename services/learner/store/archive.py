"""What people look at afterwards, read from the store by connections of its own.

Beside the `Store`: it asks for few columns where that has whole records, and nothing that it reads
holds up what arrives.
"""

from collections.abc import Sequence
from typing import Any

from sqlalchemy import Table, select

from services.learner.store.sql import open_engine
from services.learner.store.store import Answer
from services.learner.store.tables import DECISIONS, ROUNDS, RULINGS, VERSIONS
from shared.messages.decision import Decision
from shared.messages.ruling import Ruling
from shared.wire.codec import decode

Row = dict[str, Any]
_ROUND = (
    *("number", "epoch", "parent", "made", "state", "manifest", "figures", "reason"),
    *("begun_ns", "ended_ns"),
)
_VERSION = ("number", "epoch", "created_ns", "again", "ruling", "robots")


class Archive:
    """Reads a store that a learner has made. Every method may be called from any thread."""

    def __init__(self, url: str) -> None:
        self._engine = open_engine(url)

    def close(self) -> None:
        """Give the connections back."""
        self._engine.dispose()

    def decided(self, episode: str, first: int, limit: int) -> list[Decision]:
        """Up to `limit` decisions of an episode in the order of control steps, after `first`."""
        query = (
            select(DECISIONS.c.body)
            .where(DECISIONS.c.episode == episode)
            .order_by(DECISIONS.c.step, DECISIONS.c.sequence)
            .offset(first)
            .limit(limit)
        )
        with self._engine.begin() as connection:
            return [decode(Decision, body) for body in connection.scalars(query)]

    def decision(self, name: str) -> Decision | None:
        """A decision with its pictures."""
        query = select(DECISIONS.c.body).where(DECISIONS.c.id == name)
        with self._engine.begin() as connection:
            body = connection.scalar(query)
        return None if body is None else decode(Decision, body)

    def rounds(self, limit: int) -> list[Row]:
        """The last rounds, the oldest first, without candidates; `kept`: there is one."""
        return self._last(ROUNDS, _ROUND, limit, ROUNDS.c.candidate.is_not(None).label("kept"))

    def versions(self, limit: int) -> list[Row]:
        """The last versions, the oldest first, without what they are made of."""
        return self._last(VERSIONS, _VERSION, limit)

    def rulings(self, limit: int) -> list[Answer]:
        """The last rulings, the oldest first, with what became of them."""
        names = ("body", "answered_ns", "made", "reason")
        query = select(*(RULINGS.c[name] for name in names))
        query = query.order_by(RULINGS.c.sequence.desc()).limit(limit)
        with self._engine.begin() as connection:
            rows = connection.execute(query).all()
        return [
            Answer(ruling=decode(Ruling, body), answered_ns=at, made=made, reason=reason)
            for body, at, made, reason in reversed(rows)
        ]

    def _last(self, table: Table, names: Sequence[str], limit: int, *more: Any) -> list[Row]:
        columns = (*(table.c[name] for name in names), *more)
        query = select(*columns).order_by(table.c.number.desc()).limit(limit)
        with self._engine.begin() as connection:
            rows = connection.execute(query).mappings().all()
        return [dict(row) for row in reversed(rows)]
