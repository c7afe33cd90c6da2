"""A message as a row: the columns that are asked for, and the message as it travelled."""

from collections.abc import Callable
from typing import Any

from sqlalchemy import Table

from services.learner.store.store import Kept
from services.learner.store.tables import CORRECTIONS, DECISIONS, EPISODES, RECEIPTS, RULINGS
from shared.messages.correction import Correction
from shared.messages.decision import Decision
from shared.messages.episode import Episode
from shared.messages.message import Message
from shared.messages.receipt import Receipt
from shared.messages.ruling import Ruling
from shared.wire.codec import encode

Row = dict[str, Any]


def table_of(message: Kept) -> Table:
    """Where a message is kept."""
    return _PLACES[type(message)][0]


def id_of(message: Kept) -> str:
    """What a message is kept under: a receipt, by the correction that it answers."""
    return message.correction if isinstance(message, Receipt) else message.id


def row_of(message: Kept, now_ns: int) -> Row:
    """All columns of a message but its place in the order of arrival."""
    return {
        "id": id_of(message),
        "body": encode(message),
        "arrived_ns": now_ns,
        **({} if isinstance(message, Ruling) else {"robot": message.robot}),
        **_PLACES[type(message)][1](message),
    }


def _decision(message: Decision) -> Row:
    return {
        "episode": message.episode,
        "step": message.step,
        "executed": message.executed.text,
        "best": message.proposed[0].goal.text,
        "chosen_by": message.chosen_by,
        "version": str(message.version),
        "time_ns": message.time_ns,
    }


def _correction(message: Correction) -> Row:
    return {"episode": message.episode, "kind": str(message.kind), "author": message.author}


def _receipt(message: Receipt) -> Row:
    return {"episode": message.episode, "accepted": message.accepted}


def _episode(message: Episode) -> Row:
    return {
        "task": message.task,
        "version": str(message.version),
        "outcome": str(message.outcome),
        "seed": message.seed,
        "decisions": message.decisions,
        "corrections": message.corrections,
    }


def _ruling(message: Ruling) -> Row:
    return {"verb": str(message.verb), "author": message.author}


_PLACES: dict[type[Message], tuple[Table, Callable[[Any], Row]]] = {
    Decision: (DECISIONS, _decision),
    Correction: (CORRECTIONS, _correction),
    Receipt: (RECEIPTS, _receipt),
    Episode: (EPISODES, _episode),
    Ruling: (RULINGS, _ruling),
}
