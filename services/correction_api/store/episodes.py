"""Episodes that robots told of: how often each version succeeds, and finding one of them."""

from typing import Any, NamedTuple

from pydantic import BaseModel
from sqlalchemy import Connection, Engine, Select, and_, case, func, or_, select
from sqlalchemy.dialects.sqlite import insert

from services.correction_api.store.tables import calls, corrections, episodes
from services.correction_api.store.writer import Writer
from shared.messages.correction import Kind, speaking_s
from shared.messages.episode import Episode, Outcome
from shared.messages.help import Help
from shared.messages.policy import Version

_TAUGHT = (Kind.OVERRIDE, Kind.EDIT, Kind.RETIME, Kind.RELABEL)  # Said what would be right.


class Tally(NamedTuple):
    """What came of the episodes of one version; those broken off don't count."""

    version: Version
    episodes: int
    successes: int
    corrections: int


class Filter(BaseModel):
    """What an episode must be like; None: it doesn't matter.

    success: it succeeded; False: it did not, whether time ran out or it was broken off.
    corrected: somebody said what would be right, while it ran or afterwards.
    doubt: the robot called for help.
    """

    robot: str | None = None
    task: str | None = None
    version: str | None = None
    success: bool | None = None
    corrected: bool | None = None
    doubt: bool | None = None


class Found(NamedTuple):
    """An episode, how often its robot called for help, and how many things were said about it
    that are labels."""

    sequence: int
    episode: Episode
    calls: int
    taught: int


class Episodes:
    """Episodes on disk, each once by its id."""

    def __init__(self, writer: Writer, readers: Engine) -> None:
        self._writer, self._readers = writer, readers

    def add(self, episode: Episode) -> None:
        """Keep an episode; one that is there already is left alone."""
        row = {
            "id": episode.id,
            "robot": episode.robot,
            "task": episode.task,
            "version": str(episode.version),
            "outcome": episode.outcome,
            "corrections": episode.corrections,
            "message": episode.model_dump_json(),
        }

        def work(connection: Connection) -> None:
            connection.execute(insert(episodes).values(row).on_conflict_do_nothing())

        self._writer.submit(work)

    def call(self, episode: str, help: Help) -> None:
        """Keep that a robot called for help; a call that is there already is left alone."""
        row = {"decision": help.decision, "episode": episode, "message": help.model_dump_json()}

        def work(connection: Connection) -> None:
            connection.execute(insert(calls).values(row).on_conflict_do_nothing())

        self._writer.submit(work)

    def calls(self, episode: str) -> list[Help]:
        """The calls for help in an episode, in order."""
        query = select(calls.c.message).where(calls.c.episode == episode)
        with self._readers.connect() as connection:
            found = [Help.model_validate_json(text) for text in connection.scalars(query)]
        return sorted(found, key=lambda help: help.step)

    def page(self, wanted: Filter, limit: int, before: int | None) -> list[Found]:
        """Up to `limit` episodes that are like `wanted`, the newest first."""
        query = _found().order_by(episodes.c.sequence.desc()).limit(limit)
        query = query.where(*_conditions(wanted))
        if before is not None:
            query = query.where(episodes.c.sequence < before)
        return self._read(query)

    def get(self, name: str) -> Found | None:
        """The episode with this id, and what is counted of it."""
        return next(iter(self._read(_found().where(episodes.c.id == name))), None)

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

    def tasks(self) -> list[str]:
        """The tasks that there are episodes of, by name."""
        with self._readers.connect() as connection:
            return sorted(connection.scalars(select(episodes.c.task).distinct()))

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

    def attention(self) -> dict[str, float]:
        """Human seconds by version: what all corrections of its counted episodes took to say."""
        begun = func.json_extract(corrections.c.message, "$.begun_ns")
        query = (
            select(episodes.c.version, begun, corrections.c.created_ns)
            .join(episodes, episodes.c.id == corrections.c.episode)
            .where(episodes.c.outcome != Outcome.ABORTED)
        )
        spent: dict[str, float] = {}
        with self._readers.connect() as connection:
            for version, begun_ns, created_ns in connection.execute(query):
                spent[version] = spent.get(version, 0.0) + speaking_s(begun_ns, created_ns)
        return spent

    def _read(self, query: Select[Any]) -> list[Found]:
        with self._readers.connect() as connection:
            rows = connection.execute(query).all()
        return [
            Found(row.sequence, Episode.model_validate_json(row.message), row.calls, row.taught)
            for row in rows
        ]


_CALLS = (
    select(func.count())
    .where(calls.c.episode == episodes.c.id)
    .correlate(episodes)
    .scalar_subquery()
)
_SAID = (
    select(func.count())
    .where(
        and_(
            corrections.c.episode == episodes.c.id,
            corrections.c.kind.in_(_TAUGHT),
            corrections.c.status.not_in(("refused", "expired")),
        )
    )
    .correlate(episodes)
    .scalar_subquery()
)


def _found() -> Select[Any]:
    columns = (episodes.c.sequence, episodes.c.message)
    return select(*columns, _CALLS.label("calls"), _SAID.label("taught"))


def _conditions(wanted: Filter) -> list[Any]:
    met: list[Any] = [
        episodes.c[name] == value
        for name in ("robot", "task", "version")
        if (value := getattr(wanted, name)) is not None
    ]
    tests = {
        "success": episodes.c.outcome == Outcome.SUCCESS,
        "corrected": or_(episodes.c.corrections > 0, _SAID > 0),
        "doubt": _CALLS > 0,
    }
    for name, test in tests.items():
        if (asked := getattr(wanted, name)) is not None:
            met.append(test if asked else ~test)
    return met
