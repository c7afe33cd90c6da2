"""Amend: what of all that was said still stands, in which words, and over which steps.

The first part of `aggregate.py`. Nothing is ever changed in the store: a correction is taken back,
reworded or moved by another one that names it, and this puts them together anew each time.
"""

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from shared.messages.correction import (
    AFTERWARDS,
    AMENDMENTS,
    TARGETS,
    Correction,
    Kind,
)
from shared.messages.receipt import Receipt


class Standing(NamedTuple):
    """A correction as it stands.

    correction: with the words of its last edit. span: the control steps that it names, or that its
        last retime gave it; None: as it came about.
    order: when it was said or moved, to tell which of two was said later.
    retracted: it should not have been said. The robot may have obeyed it all the same.
    """

    correction: Correction
    span: range | None
    order: tuple[int, str]
    retracted: bool


def amended(corrections: Iterable[Correction], receipts: Iterable[Receipt]) -> tuple[Standing, ...]:
    """Everything that is no amendment itself, as it stands, in the order of ids.

    What is said of the past needs no receipt, since there may be no robot to give one; if a robot
    refused it, it was told to whoever said it, and counts for nothing. An amendment that does not
    fit its target, or has none here, counts for nothing either.
    """
    refused = {receipt.correction for receipt in receipts if not receipt.accepted}
    said = {
        one.id: one
        for one in sorted(corrections, key=lambda one: one.id)
        if one.kind not in AFTERWARDS or one.id not in refused
    }
    amendments = [one for one in said.values() if one.kind in AMENDMENTS and _fits(one, said)]
    retracted = {one.target for one in amendments if one.kind is Kind.RETRACT}
    last: dict[tuple[Kind, str | None], Correction] = {}
    for one in sorted(amendments, key=_order):
        if one.id not in retracted:
            last[one.kind, one.target] = one
    return tuple(
        _standing(
            one,
            last.get((Kind.EDIT, one.id)),
            last.get((Kind.RETIME, one.id)),
            one.id in retracted,
        )
        for one in said.values()
        if one.kind not in AMENDMENTS
    )


def _fits(one: Correction, said: Mapping[str, Correction]) -> bool:
    target = said.get(one.target or "")
    return (
        target is not None
        and (target.robot, target.episode) == (one.robot, one.episode)
        and target.kind in TARGETS[one.kind]
    )


def _standing(
    said: Correction, edit: Correction | None, retime: Correction | None, retracted: bool
) -> Standing:
    if edit is not None:
        said = said.model_copy(update={"goal": edit.goal})
    moved = retime or said
    return Standing(said, moved.span, _order(moved), retracted)


def _order(said: Correction) -> tuple[int, str]:
    return (said.created_ns, said.id)
