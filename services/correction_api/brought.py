"""Brought: what a round brought, in words, such as "14 corrections: 52 % → 71 %, n = 200"."""

import math
from collections.abc import Mapping

from shared.messages.lineage import Compared, RoundTold, Share


def brought(round_: RoundTold, alone: Mapping[int, Share]) -> str:
    """What came of a round.

    alone: success on evaluation seeds by number of the version, which says most; then what the
        gate tried in pairs; then agreement with labels that were kept aside.
    """
    taught = _count(round_.corrections, "correction")
    if round_.state == "running":
        return f"{taught}: at work"
    change = _change(round_, alone)
    if round_.state == "passed":
        unjudged = f"; {round_.unjudged}" if round_.unjudged and not round_.trials else ""
        return f"{taught}: {change or 'in force, and not measured'}{unjudged}"
    outcome = "held back" if round_.state == "refused" else "broken off"
    measured = f"{change}; " if change else ""
    return f"{taught}: {measured}{outcome}, since {round_.reason or 'no reason was kept'}"


def _change(round_: RoundTold, alone: Mapping[int, Share]) -> str:
    before, after = alone.get(round_.parent), alone.get(round_.made if round_.made else -1)
    if before and after:
        return f"{_moved(Compared(before=before, after=after))} on evaluation seeds"
    if round_.trials:
        return f"{_moved(round_.trials)} in the gate's paired episodes"
    if round_.held_out:
        return f"agreement with held-out labels {_moved(round_.held_out)}"
    return ""


def _moved(compared: Compared) -> str:
    before, after = compared.before, compared.after
    n = f"{before.n}" if before.n == after.n else f"{before.n} and {after.n}"
    return f"{_percent(before.share)} → {_percent(after.share)}, n = {n}"


def _percent(share: float) -> str:
    return f"{math.floor(100 * share + 0.5)} %"  # Halves go up, as on the page.


def _count(number: int, thing: str) -> str:
    return f"{number or 'no'} {thing}{'' if number == 1 else 's'}"
