"""Figures of the rounds: rates, paired differences, the gap closed, and what it cost people."""

from collections import Counter
from collections.abc import Sequence
from itertools import chain
from typing import Any

import numpy as np

from services.learner.experiments.dagger.course import Effort
from services.learner.experiments.dagger.kept import BySeed, Pace
from services.learner.experiments.dagger.lessons import Taught
from services.learner.experiments.dagger.run import Tried
from services.learner.experiments.dagger.scale import MAIN, DaggerSettings
from services.learner.experiments.dagger.targets import targets
from shared.evaluation.attempts import Row
from shared.evaluation.summary import summarize
from shared.intervals import Difference, mcnemar, paired_difference, rate, seeds_difference

HZ = 50.0
SPEAK_S = 2.0
"""An utterance, from opening one's mouth to its end; reckoned, nobody was timed."""
DRAWS = 10_000
UNTRAINED = frozenset(("base", "oracle", "live"))
"""The same for each training seed."""


def figures_of(settings: DaggerSettings, tried: Tried, site: str) -> dict[str, Any]:
    """All of them, as report.json has them."""
    last = f"{MAIN}, round {settings.rounds}"
    figures = {
        "settings": settings.model_dump(mode="json"),
        "arms": {name: _arm(rows) for name, rows in tried.rows.items()},
        "gap_closed": gap_closed(tried.rows, settings.rounds),
        "corrections_share": _corrections_share(tried.paces),
        "retention": _retention(tried, last),
        "less": {
            name: less(tried.rows[last], rows, fixed=name in UNTRAINED)
            for name, rows in tried.rows.items()
            if name != last
        },
        "people": {
            person: _people([pace for pace in tried.paces if pace.person == person])
            for person in settings.people
        },
        "teleoperation": _teleoperation(tried),
        "staleness": _staleness(tried.paces),
        "failures": {name: failures_of(tried.rows[name]) for name in ("base", last, "oracle")},
        "failed_commands": failed_commands(tried.rows[last]),
        "learned_from": _learned_from(tried.taught),
    }
    told = [target._asdict() for target in targets(figures, settings.rounds, site)]
    return {**figures, "targets": told}


def _arm(rows: BySeed) -> dict[str, Any]:
    every = [row for by_seed in rows for row in by_seed]
    summary = summarize(every)
    return {
        **rate([row.success for row in every]),
        "seeds": [rate([row.success for row in by_seed]) for by_seed in rows],
        "steps": summary["steps"],
        "wrong_decisions": summary["wrong_decisions"],
        "failures": summary["failures"],
        "tasks": {
            task: rate([row.success for row in every if row.task == task])
            for task in summary["tasks"]
        },
    }


def _outcomes(rows: BySeed, seeds: int) -> list[list[float]]:
    """Of the first training seeds."""
    return [[float(row.success) for row in by_seed] for by_seed in rows[:seeds]]


def less(rows: BySeed, others: BySeed, *, fixed: bool = False) -> dict[str, Any]:
    """How much better the first are, on the same scenes and the training seeds that both have.

    fixed: the others are the same for each training seed, and there once.
    """
    others = others * len(rows) if fixed else others
    seeds = min(len(rows), len(others))
    mine, its = _outcomes(rows, seeds), _outcomes(others, seeds)
    return _told(seeds_difference(mine, its), _p(mine, its), sum(map(len, mine)))


def _p(mine: Sequence[Sequence[float]], its: Sequence[Sequence[float]]) -> float:
    """McNemar's of the training seed where it is largest, of those that have any pairs."""
    return max(
        mcnemar([won > 0 for won in one], [won > 0 for won in other])
        for one, other in zip(mine, its, strict=True)
        if one
    )


def _told(gap: Difference, p: float, n: int) -> dict[str, Any]:
    return {
        "difference": round(gap.value, 4),
        "interval": [round(gap.low, 4), round(gap.high, 4)],
        "p": round(p, 4),
        "n": n,
    }


def gap_closed(rows: dict[str, BySeed], rounds: int) -> dict[str, Any]:
    """(after each round - base) / (oracle - base), with the interval of the last.

    The bootstrap draws training seeds, and scenes once for all arms. None where the oracle isn't
    better than the base by its interval: a share of nothing says nothing.
    """
    if less(rows["oracle"], rows["base"])["interval"][0] <= 0:
        return {"value": None, "interval": None, "rounds": [None] * rounds}
    names = [f"{MAIN}, round {number}" for number in range(1, rounds + 1)]
    seeds = len(rows[names[-1]])
    wide = [
        np.array(_outcomes(some, seeds))
        for some in (
            *(rows[name] * seeds for name in ("base", "oracle")),
            *(rows[name] for name in names),
        )
    ]  # [S, N] each.
    base, oracle, *after = (float(one.mean()) for one in wide)
    rng = np.random.default_rng(0)
    shares = []
    for _ in range(DRAWS):
        drawn = rng.integers(seeds, size=seeds)
        scenes = rng.integers(wide[0].shape[1], size=wide[0].shape[1])
        low, high, top = (one[drawn][:, scenes].mean() for one in (wide[0], wide[1], wide[-1]))
        if high > low:  # All but never otherwise, by the interval above.
            shares.append((top - low) / (high - low))
    lower, upper = np.percentile(shares, [2.5, 97.5])
    return {
        "value": round((after[-1] - base) / (oracle - base), 4),
        "interval": [round(float(lower), 4), round(float(upper), 4)],
        "rounds": [round((one - base) / (oracle - base), 4) for one in after],
    }


def _corrections_share(paces: Sequence[Pace]) -> dict[str, Any]:
    """Corrections per 100 decisions of the collected episodes, over all rounds and by round.

    value, rounds: overrides, relabels, endorsements. with_releases: that somebody let go, too.
    """
    efforts = [pace.efforts for pace in paces if pace.person == MAIN]
    every = [effort for some in efforts for effort in some]
    return {
        "value": _per_hundred(every),
        "rounds": [_per_hundred(some) for some in zip(*efforts, strict=True)],
        "with_releases": _per_hundred(every, releases=True),
    }


def _per_hundred(efforts: Sequence[Effort], *, releases: bool = False) -> float:
    said = sum(effort.corrections + releases * effort.releases for effort in efforts)
    return round(100 * said / max(1, sum(effort.decisions for effort in efforts)), 2)


def _retention(tried: Tried, last: str) -> dict[str, Any]:
    """Success in the lab, where nobody corrected, after the last round less before the first.

    unseen: here, on prompts that were never corrected in any round, after and before.
    """
    base = tried.lab["base"]
    gap = less(tried.lab["last"], base, fixed=True)
    return {
        "lab": gap,
        "before": _arm(base),
        "after": _arm(tried.lab["last"]),
        "arms": {
            name: {**_arm(rows), "less": less(rows, base, fixed=True)}
            for name, rows in tried.lab.items()
            if name not in ("base", "last")
        },
        "unseen": _unseen(tried, last),
    }


def _unseen(tried: Tried, last: str) -> dict[str, Any]:
    """Success on prompts that nobody corrected; less: None where there is no such scene.

    Each training seed has other prompts, so that its pairs are taken as they are, and all together.
    """
    by_seed = [
        [
            (mine.success, before.success)
            for mine, before in zip(rows, tried.rows["base"][0], strict=True)
            if mine.prompt not in prompts
        ]
        for rows, prompts in zip(tried.rows[last], tried.prompts, strict=True)
    ]
    after, before = ([[pair[side] for pair in pairs] for pairs in by_seed] for side in (0, 1))
    mine, its = [*chain(*after)], [*chain(*before)]
    gap = _told(paired_difference(mine, its), _p(after, before), len(mine)) if mine else None
    return {"after": rate(mine), "before": rate(its), "less": gap}


def _people(paces: Sequence[Pace]) -> list[dict[str, Any]]:
    """By round, over the training seeds."""
    rounds = []
    for efforts in zip(*(pace.efforts for pace in paces), strict=True):
        episodes = sum(effort.episodes for effort in efforts)
        said = sum(effort.corrections + effort.releases for effort in efforts)
        rounds.append(
            {
                "episodes": episodes,
                "decisions": sum(effort.decisions for effort in efforts),
                "overrides": sum(effort.overrides for effort in efforts),
                "releases": sum(effort.releases for effort in efforts),
                "relabels": sum(effort.relabels for effort in efforts),
                "endorsements": sum(effort.endorsements for effort in efforts),
                "corrections_per_episode": round(
                    sum(effort.corrections for effort in efforts) / max(1, episodes), 2
                ),
                "per_100_decisions": _per_hundred(efforts),
                "speaking_s": round(said * SPEAK_S / len(paces), 1),
                "watching_s": round(sum(effort.steps for effort in efforts) / HZ / len(paces), 1),
                "success_with_help": _share(
                    sum(effort.successes - effort.alone for effort in efforts),
                    sum(effort.episodes - effort.reviewed for effort in efforts),
                ),
                "success_alone": _share(
                    sum(effort.alone for effort in efforts),
                    sum(effort.reviewed for effort in efforts),
                ),
            }
        )
    return rounds


def _share(some: int, many: int) -> float | None:
    return round(some / many, 4) if many else None


def _teleoperation(tried: Tried) -> dict[str, Any]:
    """What demonstrations by hand took, by arm, a training seed: decisions and minutes."""
    found = {}
    for name in ("lab", "site"):
        some = [one for one in tried.taught if one.lesson.arm == name]
        if some:
            found[name] = {
                "decisions": round(sum(one.labels for one in some) / len(some)),
                "minutes": round(sum(one.steps for one in some) / len(some) / HZ / 60, 1),
            }
    return found


def _staleness(paces: Sequence[Pace]) -> list[dict[str, int]]:
    """By round, over the training seeds: episodes by how many versions ago they ran."""
    mine = [pace.staleness for pace in paces if pace.person == MAIN]
    return [dict(sum(map(Counter, some), Counter[str]())) for some in zip(*mine, strict=True)]


def failures_of(rows: BySeed) -> dict[str, float]:
    """Share of all episodes by what went wrong first."""
    every: list[Row] = [row for by_seed in rows for row in by_seed]
    found = Counter(row.failure for row in every if not row.success)
    return {kind: round(count / len(every), 4) for kind, count in found.most_common()}


def failed_commands(rows: BySeed) -> list[dict[str, Any]]:
    """Under which command what went wrong first, the most frequent first.

    share: of all episodes. "": nothing was attempted yet.
    """
    every = [row for by_seed in rows for row in by_seed]
    found = Counter(
        (row.attempts[-1].command if row.attempts else "", row.failure)
        for row in every
        if not row.success
    )
    return [
        {"command": command, "failure": kind, "count": count, "share": round(count / len(every), 4)}
        for (command, kind), count in sorted(found.items(), key=lambda one: (-one[1], one[0]))
    ]


def _learned_from(taught: Sequence[Taught]) -> dict[str, dict[str, float]]:
    """By arm, means over the training seeds: labelled decisions, and corrections that gave them."""
    return {
        name: {
            "labels": float(np.mean([one.labels for one in some])),
            "corrections": float(np.mean([one.corrections for one in some])),
        }
        for name in dict.fromkeys(one.lesson.arm for one in taught)
        for some in [[one for one in taught if one.lesson.arm == name]]
    }
