"""Episodes that robots told of, so that the page can say how often each version succeeds."""

from typing import NamedTuple

from sqlalchemy import Connection, Engine, case, func, select
from sqlalchemy.dialects.sqlite import insert

from services.correction_api.store.tables import episodes
from services.correction_api.store.writer import Writer
from shared.messages.episode import Episode, Outcome
from shared.messages.policy import Version


class Tally(NamedTuple):
    """What came of the episodes of one version; those broken off don't count."""

    version: Version
    episodes: int
    successes: int
    corrections: int


class Episodes:
    """Episodes on disk, each once by its id."""

    def __init__(self, writer: Writer, readers: Engine) -> None:
        self._writer, self._readers = writer, readers

    def add(self, episode: Episode) -> None:
        """Keep an episode; one that is there already is left alone."""
        row = {
            "id": episode.id,
            "robot": episode.robot,
            "version": str(episode.version),
            "outcome": episode.outcome,
            "corrections": episode.corrections,
            "message": episode.model_dump_json(),
        }

        def work(connection: Connection) -> None:
            connection.execute(insert(episodes).values(row).on_conflict_do_nothing())

        self._writer.submit(work)

    def page(self, robot: str | None, limit: int, before: int | None) -> list[tuple[int, Episode]]:
        """Up to `limit` episodes with their sequence numbers, the newest first."""
        query = select(episodes.c.sequence, episodes.c.message)
        query = query.order_by(episodes.c.sequence.desc()).limit(limit)
        if robot is not None:
            query = query.where(episodes.c.robot == robot)
        if before is not None:
            query = query.where(episodes.c.sequence < before)
        with self._readers.connect() as connection:
            rows = connection.execute(query).all()
        return [(row.sequence, Episode.model_validate_json(row.message)) for row in rows]

    def find(self, name: str) -> Episode | None:
        """The episode with this id, if it was told of, so that it is over."""
        query = select(episodes.c.message).where(episodes.c.id == name)
        with self._readers.connect() as connection:
            row = connection.execute(query).one_or_none()
        return Episode.model_validate_json(row.message) if row else None

    def ended(self, name: str) -> bool:
        """An episode with this id was told of, so it is over."""
        query = select(episodes.c.sequence).where(episodes.c.id == name)
        with self._readers.connect() as connection:
            return connection.execute(query).first() is not None

    def tally(self) -> list[Tally]:
        """Success per version, the oldest version first."""
        success = case((episodes.c.outcome == Outcome.SUCCESS, 1), else_=0)
        query = (
            select(
                episodes.c.version,
                func.count().label("episodes"),
                func.sum(success).label("successes"),
                func.sum(episodes.c.corrections).label("corrections"),
            )
            .where(episodes.c.outcome != Outcome.ABORTED)
            .group_by(episodes.c.version)
        )
        with self._readers.connect() as connection:
            rows = connection.execute(query).all()
        return sorted(Tally(Version.parse(row[0]), row[1], row[2], row[3]) for row in rows)
