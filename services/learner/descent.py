"""Descent: what a version came of: the round that made its weights, and who put them in force.

For the cards of checkpoints (`shelf.py`), `hld policy` (`versions.py`) and whoever asks what was
learned where (`lessons.py`).
"""

from collections.abc import Iterable, Sequence
from datetime import UTC, datetime
from typing import NamedTuple

from services.learner.store.store import Answer, PolicyRecord, Round, Store
from shared.messages.ruling import Ruling, Verb


class Descent(NamedTuple):
    """What a version came of.

    round: that made its weights; None: they are those that the run began with.
    again: the number of the version that had these weights first, where that is another one.
    ruling: what somebody decided, where the version came about by that.
    """

    round: Round | None = None
    again: int | None = None
    ruling: Ruling | None = None


def descent(record: PolicyRecord, store: Store) -> Descent:
    """What a version that is kept came of."""
    return descents(store.versions(), store.rounds(), store.answers())[record.number]


def descents(
    versions: Sequence[PolicyRecord], rounds: Iterable[Round], answers: Iterable[Answer]
) -> dict[int, Descent]:
    """The same for all versions, by their numbers. versions: the oldest first."""
    by_number = {one.number: one for one in rounds}
    made_by = {one.made: one for one in by_number.values() if one.made is not None}
    ruled = {answer.ruling.id: answer.ruling for answer in answers}
    found: dict[int, Descent] = {}
    for version in versions:
        ruling = ruled.get(version.ruling)
        if version.again is not None:
            first = found[version.again]
            again = version.again if first.again is None else first.again
            found[version.number] = Descent(first.round, again, ruling)
            continue
        round_ = made_by.get(version.number)
        if ruling and ruling.verb is Verb.PROMOTE:
            round_ = by_number.get(ruling.round or 0)
        found[version.number] = Descent(round_, None, ruling)
    return found


def tell(came_of: Descent) -> tuple[str, ...]:
    """The same in sentences, in the order of the work."""
    round_, ruling = came_of.round, came_of.ruling
    told = [*_made(round_)]
    if ruling and ruling.verb is Verb.PROMOTE and round_:
        told.append(f"The gate held it back: {round_.reason}")
    if came_of.again is not None:
        told.append(f"These are the weights of version number {came_of.again} again.")
    if ruling:
        reason = f": {ruling.reason}" if ruling.reason else "."
        told.append(f"{ruling.author} put it in force on {date(ruling.created_ns)}{reason}")
    elif came_of.again is not None:
        told.append("The learner put it in force, in place of one that some robots ran first.")
    return tuple(told)


def _made(round_: Round | None) -> tuple[str, ...]:
    if round_ is None:
        return ("The checkpoint that the run began with, unchanged.",)
    return (
        f"Round {round_.number}, from the version number {round_.parent} of the same run.",
        f"Fine-tuned on the demonstrations and {round_.figures.get('labels')} labels of all rounds "
        f"so far; the data hash is that of the labels.",
        f"Settings: {round_.manifest.settings.get('train')}.",
    )


def date(time_ns: int) -> str:
    """A day, such as 2026-11-30, in UTC."""
    return datetime.fromtimestamp(time_ns / 1e9, UTC).date().isoformat()
