"""What the rounds are to reach, held against what they reached.

A figure counts by its value; its interval stands beside it, since it may reach beyond.
"""

from itertools import pairwise
from typing import Any, NamedTuple

from services.learner.experiments.dagger.scale import LAB, MAIN
from services.learner.experiments.findings import Table

GAP = 0.8
PER_100 = 15.0
BEHIND_LIVE = 0.05
FORGOTTEN = 0.02


_REACHED = {True: "yes", False: "**short**", None: ""}


class Target(NamedTuple):
    """what: is asked. wanted, found: as people read them. reached: by the value; None: it can't be
    told here."""

    what: str
    wanted: str
    found: str
    reached: bool | None


def targets(figures: dict[str, Any], rounds: int, site: str) -> list[Target]:
    """Those that this run has the arms for. figures: as report.json has them."""
    gap, share, less = figures["gap_closed"], figures["corrections_share"], figures["less"]
    kept = figures["retention"]["lab"]
    value, told = gap["value"], "the oracle isn't better than the base here by its interval"
    if value is not None:
        low, high = gap["interval"]
        told = f"{value:.2f} ({low:.2f} to {high:.2f})"
    falling = all(late < early for early, late in pairwise(share["rounds"]))
    by_round = ", ".join(f"{one:.1f}" for one in share["rounds"])
    found = [
        Target(
            f"gap between base and oracle closed after {rounds} rounds",
            f"{GAP:.2f} or more",
            told,
            None if value is None else value >= GAP,
        ),
        Target(
            "corrections per 100 decisions, over all rounds",
            f"{PER_100:.0f} or fewer",
            f"{share['value']:.1f}; with releases {share['with_releases']:.1f}",
            share["value"] <= PER_100,
        ),
        Target("the same by round", "falling", by_round, falling),
        _at_least("less live-corrected", less["live"], -BEHIND_LIVE),
        _at_least("in the lab, less before", kept, -FORGOTTEN),
    ]
    if site == LAB:  # What was corrected there was not to be retained.
        found[-1] = found[-1]._replace(reached=None)
    beaten = (("lab", "extra demonstrations in the lab"), ("shuffled", "shuffled corrections"))
    return found + [
        Target(f"less {title}", "above 0, by its interval", _gap(less[name]), _above(less[name]))
        for name, title in beaten
        if name in less
    ]


def _at_least(what: str, gap: dict[str, Any], least: float) -> Target:
    return Target(what, f"{least:+.2f} or more", _gap(gap), gap["difference"] >= least)


def _gap(gap: dict[str, Any]) -> str:
    low, high = gap["interval"]
    return f"{gap['difference']:+.3f} ({low:+.3f} to {high:+.3f})"


def _above(gap: dict[str, Any]) -> bool:
    return bool(gap["interval"][0] > 0)


def targets_table(figures: dict[str, Any], rounds: int) -> Table:
    """One line each; the version after the last round is what is compared."""
    return Table(
        title="To be reached",
        columns=(f"{MAIN}, round {rounds}", "wanted", "measured (95 %)", "reached?"),
        rows=tuple(
            (one["what"], one["wanted"], one["found"], _REACHED[one["reached"]])
            for one in figures["targets"]
        ),
    )
