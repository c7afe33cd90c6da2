"""The questions that the store answers, in SQL; each runs in the transaction that it is given."""

from collections.abc import Callable
from typing import Any

from sqlalchemy import (
    ColumnElement,
    Connection,
    ScalarSelect,
    Select,
    and_,
    func,
    insert,
    or_,
    select,
    update,
)

from services.learner.store.store import (
    Arrival,
    Manifest,
    Marks,
    PolicyRecord,
    Round,
    RoundState,
    Tally,
)
from services.learner.store.tables import (
    CORRECTIONS,
    DECISIONS,
    EPISODES,
    EPOCHS,
    RECEIPTS,
    ROUNDS,
    RULINGS,
    VERSIONS,
)
from shared.errors import RefusedError
from shared.messages.correction import HINDSIGHT, Correction, Kind
from shared.messages.episode import Outcome
from shared.wire.codec import decode


def epoch(connection: Connection) -> int:
    """The epoch in force, 0 before the first."""
    return connection.scalar(select(func.max(EPOCHS.c.number))) or 0


def check_epoch(connection: Connection, mine: int) -> None:
    """Hold an epoch against the one in force.

    Raises:
        RefusedError: another learner took the store over.
    """
    if (now := epoch(connection)) != mine:
        raise RefusedError(f"the store is in epoch {now}, which is not {mine}")


def marks(connection: Connection) -> Marks:
    """The last row of each table of arrivals."""
    tables = (DECISIONS, CORRECTIONS, RECEIPTS, EPISODES, RULINGS)
    last = (connection.scalar(select(func.max(table.c.sequence))) for table in tables)
    return Marks(**{table.name: number or 0 for table, number in zip(tables, last, strict=True)})


def tally(connection: Connection, since: Marks) -> Tally:
    """What arrived after `since`."""
    fresh = and_(EPISODES.c.sequence > since.episodes, EPISODES.c.outcome != str(Outcome.ABORTED))
    questions = (
        select(func.count()).where(fresh),
        select(func.count()).where(fresh, EPISODES.c.outcome == str(Outcome.SUCCESS)),
        select(func.count()).select_from(_OBEYED).where(RECEIPTS.c.sequence > since.receipts),
        select(func.count()).where(DECISIONS.c.sequence > since.decisions),
    )
    return Tally(*(connection.scalar(question) or 0 for question in questions))


def arrivals(connection: Connection, after: Manifest) -> tuple[Arrival, ...]:
    """The episodes that no round has used, and how complete they are."""
    here = _count(DECISIONS.c.episode)
    obeyed = (
        select(func.count())
        .select_from(_OBEYED)
        .where(RECEIPTS.c.episode == EPISODES.c.id)
        .correlate(EPISODES)
        .scalar_subquery()
    )
    query = (
        select(
            EPISODES.c.id,
            EPISODES.c.outcome == str(Outcome.ABORTED),
            EPISODES.c.arrived_ns,
            EPISODES.c.decisions - here,
            EPISODES.c.corrections - obeyed,
            obeyed,
        )
        .where(
            or_(
                EPISODES.c.sequence > after.marks.episodes,
                EPISODES.c.id.in_(after.excluded),
            )
        )
        .order_by(EPISODES.c.sequence)
    )
    rows = connection.execute(query)
    return tuple(
        Arrival(id_, bool(aborted), at, max(0, decisions), max(0, corrections), overrides)
        for id_, aborted, at, decisions, corrections, overrides in rows
    )


def hindsight(connection: Connection, after: Manifest) -> int:
    """How many commands were said of the past since, and how many that it had were taken back."""
    since = CORRECTIONS.c.sequence > after.marks.corrections
    said = select(func.count()).where(since, CORRECTIONS.c.kind.in_(map(str, HINDSIGHT)))
    retracts = select(CORRECTIONS.c.body).where(since, CORRECTIONS.c.kind == str(Kind.RETRACT))
    targets = {decode(Correction, body).target for body in connection.scalars(retracts)}
    had = select(func.count()).where(
        CORRECTIONS.c.id.in_(targets),
        CORRECTIONS.c.sequence <= after.marks.corrections,
        CORRECTIONS.c.episode.in_(episodes_of(after)(EPISODES.c.id)),
    )
    return (connection.scalar(said) or 0) + (connection.scalar(had) or 0 if targets else 0)


def episodes_of(manifest: Manifest) -> Callable[[ColumnElement[Any]], Select[Any]]:
    """A select of some column over the episodes that `manifest` speaks of."""

    def choose(column: ColumnElement[Any]) -> Select[Any]:
        return select(column).where(
            EPISODES.c.sequence <= manifest.marks.episodes,
            EPISODES.c.id.not_in(manifest.excluded),
        )

    return choose


def keep_version(connection: Connection, version: PolicyRecord, trial: bool = False) -> None:
    """Keep a version. trial: one of its number that is on trial gives way to it.

    Raises:
        RefusedError: its epoch is no longer in force, or its number is taken.
    """
    check_epoch(connection, version.epoch)
    taken = VERSIONS.c.number == version.number
    held = connection.scalar(select(VERSIONS.c.robots).where(taken))
    row = version.model_dump(mode="json")
    if held is None:
        connection.execute(insert(VERSIONS).values(**row))
    elif held and trial:
        connection.execute(update(VERSIONS).where(taken).values(**row))
    else:
        raise RefusedError(f"there is a version {version.number} already")


def keep_round(connection: Connection, round_: Round) -> None:
    """Keep what has become of a round.

    Raises:
        RefusedError: it is not running.
    """
    kept = connection.execute(
        update(ROUNDS)
        .where(ROUNDS.c.number == round_.number, ROUNDS.c.state == RoundState.RUNNING)
        .values(**round_.model_dump(mode="json"))
    )
    if kept.rowcount != 1:
        raise RefusedError(f"round {round_.number} is not running")


# Accepted receipts with the override that each of them answers.
_OBEYED = RECEIPTS.join(
    CORRECTIONS,
    and_(
        CORRECTIONS.c.id == RECEIPTS.c.id,
        CORRECTIONS.c.kind == str(Kind.OVERRIDE),
        RECEIPTS.c.accepted,
    ),
)


def _count(column: ColumnElement[str]) -> ScalarSelect[int]:
    return select(func.count()).where(column == EPISODES.c.id).correlate(EPISODES).scalar_subquery()
