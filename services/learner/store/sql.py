"""The store in a database: SQLite beside the run by default, or any that SQLAlchemy speaks."""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from sqlalchemy import Connection, Engine, create_engine, event, func, insert, select, true, update

from services.learner.store import queries
from services.learner.store.migrate import migrate
from services.learner.store.rows import id_of, row_of, table_of
from services.learner.store.store import (
    Answer,
    DecisionHead,
    History,
    Kept,
    Manifest,
    Marks,
    PolicyRecord,
    Round,
    Survey,
    Tally,
    Trial,
)
from services.learner.store.tables import (
    CORRECTIONS,
    DECISIONS,
    EPISODES,
    EPOCHS,
    RECEIPTS,
    ROUNDS,
    RULINGS,
    TRIALS,
    VERSIONS,
)
from services.learner.store.writer import Writer
from shared.errors import RefusedError
from shared.messages.correction import Correction
from shared.messages.decision import Decision
from shared.messages.episode import Episode
from shared.messages.receipt import Receipt
from shared.messages.ruling import Ruling
from shared.wire.codec import decode


def open_engine(url: str) -> Engine:
    """An engine whose transactions are as durable as its database can make them."""
    engine = create_engine(url)
    if engine.dialect.name == "sqlite":
        event.listen(engine, "connect", _prepare)
        event.listen(engine, "begin", _begin)
    return engine


def _prepare(connection: Any, record: Any) -> None:
    del record  # Unused.
    # sqlite3 would begin transactions late and lose savepoints; `_begin` does it instead.
    connection.isolation_level = None
    for pragma in ("journal_mode=WAL", "synchronous=FULL", "foreign_keys=ON", "busy_timeout=5000"):
        connection.execute(f"PRAGMA {pragma}")


def _begin(connection: Connection) -> None:
    # A writer takes its lock at once: one that began as a reader could not be made to wait.
    writes = connection.get_execution_options().get("writes", False)
    connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")


def sqlite_url(file: Path) -> str:
    """The URL of a SQLite file."""
    return f"sqlite:///{file}"


class SqlStore:
    """A `Store` in a database. Reads go beside the one writer (`writer.py`)."""

    def __init__(self, url: str) -> None:
        """Open the store and bring its tables to the form of today."""
        self._engine = open_engine(url)
        writing = self._engine.execution_options(writes=True)
        with writing.begin() as connection:
            migrate(connection)
        self._writer = Writer(writing)

    def close(self) -> None:
        """Give everything back; what waits is written first."""
        self._writer.close()
        self._engine.dispose()

    # -- what arrives

    def add(self, message: Kept, now_ns: int) -> bool:
        row, table = row_of(message, now_ns), table_of(message)

        def work(connection: Connection) -> bool:
            held = connection.scalar(select(table.c.body).where(table.c.id == row["id"]))
            if held is None:
                connection.execute(insert(table).values(**row))
            elif held != row["body"]:
                raise RefusedError(
                    f"another {type(message).__name__.lower()} has the id {id_of(message)}"
                )
            return held is None

        return self._writer.do(work)

    def tally(self, since: Marks) -> Tally:
        with self._engine.begin() as connection:
            return queries.tally(connection, since)

    def survey(self, after: Manifest) -> Survey:
        with self._engine.begin() as connection:
            return Survey(
                queries.marks(connection),
                queries.arrivals(connection, after),
                queries.hindsight(connection, after),
            )

    def history(self, manifest: Manifest) -> History:
        marks, known = manifest.marks, queries.episodes_of(manifest)
        heads = select(*(DECISIONS.c[name] for name in DecisionHead._fields)).where(
            DECISIONS.c.sequence <= marks.decisions, DECISIONS.c.episode.in_(known(EPISODES.c.id))
        )
        bodies = (
            known(EPISODES.c.body),
            select(CORRECTIONS.c.body).where(
                CORRECTIONS.c.sequence <= marks.corrections,
                CORRECTIONS.c.episode.in_(known(EPISODES.c.id)),
            ),
            select(RECEIPTS.c.body).where(
                RECEIPTS.c.sequence <= marks.receipts,
                RECEIPTS.c.episode.in_(known(EPISODES.c.id)),
            ),
            select(RULINGS.c.body).where(RULINGS.c.sequence <= marks.rulings),
        )
        with self._engine.begin() as connection:
            decisions = tuple(DecisionHead(*row) for row in connection.execute(heads))
            episodes, corrections, receipts, rulings = (
                [*connection.scalars(body)] for body in bodies
            )
        return History(
            decisions,
            tuple(decode(Correction, body) for body in corrections),
            tuple(decode(Receipt, body) for body in receipts),
            tuple(decode(Episode, body) for body in episodes),
            tuple(decode(Ruling, body) for body in rulings),
        )

    def episodes_under(self, number: int) -> tuple[Episode, ...]:
        under = EPISODES.c.version.like(f"%.{number}")
        query = select(EPISODES.c.body).where(under).order_by(EPISODES.c.sequence)
        with self._engine.begin() as connection:
            return tuple(decode(Episode, body) for body in connection.scalars(query))

    def decisions(self, ids: Iterable[str]) -> Iterator[Decision]:
        with self._engine.begin() as connection:
            for id_ in ids:
                body = connection.scalar(select(DECISIONS.c.body).where(DECISIONS.c.id == id_))
                if body is None:
                    raise RefusedError(f"no decision has the id {id_}")
                yield decode(Decision, body)

    # -- what is made of it

    def take_over(self, learner: str, now_ns: int) -> int:
        def work(connection: Connection) -> int:
            epoch = queries.epoch(connection) + 1
            connection.execute(
                insert(EPOCHS).values(number=epoch, learner=learner, taken_ns=now_ns)
            )
            return epoch

        return self._writer.do(work)

    def epoch(self) -> int:
        with self._engine.begin() as connection:
            return queries.epoch(connection)

    def begin(self, round_: Round) -> None:
        def work(connection: Connection) -> None:
            queries.check_epoch(connection, round_.epoch)
            if connection.scalar(select(ROUNDS.c.number).where(ROUNDS.c.number == round_.number)):
                raise RefusedError(f"round {round_.number} was begun before")
            connection.execute(insert(ROUNDS).values(**round_.model_dump(mode="json")))

        self._writer.do(work)

    def advance(self, round_: Round, version: PolicyRecord | None = None) -> None:
        def work(connection: Connection) -> None:
            if version is not None:
                queries.keep_version(connection, version)
            queries.keep_round(connection, round_)

        self._writer.do(work)

    def end(self, round_: Round, version: PolicyRecord | None = None) -> None:
        def work(connection: Connection) -> None:
            if version is not None:
                queries.keep_version(connection, version, trial=version.number == round_.made)
            queries.keep_round(connection, round_)

        self._writer.do(work)

    def rounds(self) -> tuple[Round, ...]:
        with self._engine.begin() as connection:
            rows = connection.execute(select(ROUNDS).order_by(ROUNDS.c.number)).mappings()
            return tuple(Round.model_validate(dict(row)) for row in rows)

    def found(self, version: PolicyRecord) -> None:
        def work(connection: Connection) -> None:
            queries.check_epoch(connection, version.epoch)
            if connection.scalar(select(func.count()).select_from(VERSIONS)):
                raise RefusedError("the store has a version already")
            connection.execute(insert(VERSIONS).values(**version.model_dump(mode="json")))

        self._writer.do(work)

    def version(self, number: int | None = None) -> PolicyRecord | None:
        if number is None:
            return next((one for one in reversed(self.versions()) if not one.robots), None)
        query = select(VERSIONS).where(VERSIONS.c.number == number)
        with self._engine.begin() as connection:
            row = connection.execute(query).mappings().one_or_none()
            return None if row is None else PolicyRecord.model_validate(dict(row))

    def versions(self) -> tuple[PolicyRecord, ...]:
        with self._engine.begin() as connection:
            rows = connection.execute(select(VERSIONS).order_by(VERSIONS.c.number)).mappings()
            return tuple(PolicyRecord.model_validate(dict(row)) for row in rows)

    # -- what people decided, and what the gate tried

    def answers(self) -> tuple[Answer, ...]:
        names = ("body", "answered_ns", "made", "reason")
        query = select(*(RULINGS.c[name] for name in names)).order_by(RULINGS.c.sequence)
        with self._engine.begin() as connection:
            return tuple(
                Answer(
                    ruling=decode(Ruling, body), answered_ns=answered_ns, made=made, reason=reason
                )
                for body, answered_ns, made, reason in connection.execute(query)
            )

    def answer(self, answer: Answer, version: PolicyRecord | None = None) -> None:
        def work(connection: Connection) -> None:
            if version is not None:
                queries.keep_version(connection, version)
            answered = connection.execute(
                update(RULINGS)
                .where(RULINGS.c.id == answer.ruling.id, RULINGS.c.answered_ns.is_(None))
                .values(answered_ns=answer.answered_ns, made=answer.made, reason=answer.reason)
            )
            if answered.rowcount != 1:
                raise RefusedError(f"ruling {answer.ruling.id} is unknown or was answered before")

        self._writer.do(work)

    def trials(self, policy: str, plan: str) -> dict[int, Trial]:
        query = select(TRIALS).where(TRIALS.c.policy == policy, TRIALS.c.plan == plan)
        with self._engine.begin() as connection:
            rows = connection.execute(query).mappings()
            return {row["seed"]: Trial.model_validate(dict(row)) for row in rows}

    def add_trial(self, trial: Trial) -> bool:
        row = trial.model_dump(mode="json")
        keys = [TRIALS.c[name] == row[name] for name in ("policy", "plan", "seed")]

        def work(connection: Connection) -> bool:
            fresh = connection.scalar(select(true()).where(*keys)) is None
            if fresh:
                connection.execute(insert(TRIALS).values(**row))
            return fresh

        return self._writer.do(work)
