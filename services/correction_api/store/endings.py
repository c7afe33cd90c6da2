"""Endings: which correction ended which, derived from receipts; the earlier row is never touched.

A receipt says whose word held until then, and both are of one episode, by which rows are found.
"""

from collections.abc import Sequence
from typing import Any

from sqlalchemy import Connection, Row, func, select

from services.correction_api.store.tables import corrections
from shared.messages.correction import Correction, Kind
from shared.messages.receipt import Receipt


def ended_by(correction: Correction, receipt: Receipt) -> str | None:
    """The correction that held until this one was obeyed. One that is reworded holds on."""
    return None if correction.kind is Kind.EDIT else receipt.replaced


def find_endings(connection: Connection, ended: Sequence[Row[Any]]) -> dict[str, Row[Any]]:
    """The rows that ended these, by the ids of the latter; the first one where several say so."""
    if not ended:
        return {}
    replaced = func.json_extract(corrections.c.receipt, "$.replaced").label("replaced")
    query = (
        select(corrections, replaced)
        .where(corrections.c.episode.in_({row.episode for row in ended}))
        .where(corrections.c.kind != Kind.EDIT)
        .where(replaced.in_([row.id for row in ended]))
        .order_by(corrections.c.sequence.desc())
    )
    return {row.replaced: row for row in connection.execute(query)}
