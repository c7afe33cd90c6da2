"""What came of the rounds: rates, paired differences, the gap closed, and what it cost people."""

from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np

from services.learner.experiments.dagger.course import Effort
from services.learner.experiments.dagger.run import BySeed, Pace, Tried
from services.learner.experiments.dagger.scale import ARMS, MAIN, DaggerSettings
from services.learner.experiments.findings import (
    Curve,
    Findings,
    Panel,
    Plot,
    Table,
    cell,
    curve,
    gap_cell,
)
from shared.evaluation.attempts import Row
from shared.evaluation.summary import summarize
from shared.intervals import mcnemar, rate, seeds_difference

HZ = 50.0
SPEAK_S = 2.0
"""An utterance, from opening one's mouth to its end; reckoned, nobody was timed."""
DRAWS = 10_000


def findings(settings: DaggerSettings, tried: Tried, site: str) -> Findings:
    """rows of every arm, told for machines and for people."""
    last = f"{MAIN}, round {settings.rounds}"
    figures = {
        "settings": settings.model_dump(mode="json"),
        "arms": {name: _arm(rows) for name, rows in tried.rows.items()},
        "gap_closed": gap_closed(tried.rows, settings.rounds),
        "corrections_share": _corrections_share(tried.paces),
        "retention": _retention(tried, last),
        "less": {
            name: _less(tried.rows[last], rows) for name, rows in tried.rows.items() if name != last
        },
        "people": {
            person: _people([pace for pace in tried.paces if pace.person == person])
            for person in settings.people
        },
        "teleoperation": _teleoperation(tried),
        "staleness": _staleness(settings),
    }
    return Findings(
        title="Do corrections help, and is it the corrections?",
        method=_method(settings),
        figures=figures,
        tables=(
            _arms_table(figures, last),
            _rounds_table(figures),
            _tasks_table(figures),
            _failures_table(tried.rows, last),
        ),
        plots=(_plot(figures, settings, site),),
        notes=_notes(settings),
    )


# -- figures


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
    """By training seed; what was not trained is the same for each."""
    wide = rows if len(rows) == seeds else rows * seeds
    return [[float(row.success) for row in by_seed] for by_seed in wide]


def _less(rows: BySeed, others: BySeed) -> dict[str, Any]:
    """How much better the first are, on the same scenes and training seeds."""
    seeds = max(len(rows), len(others))
    mine, its = _outcomes(rows, seeds), _outcomes(others, seeds)
    gap = seeds_difference(mine, its)
    by_seed = [
        mcnemar([won > 0 for won in one], [won > 0 for won in other])
        for one, other in zip(mine, its, strict=True)
    ]
    return {
        "difference": round(gap.value, 4),
        "interval": [round(gap.low, 4), round(gap.high, 4)],
        "p": round(max(by_seed), 4),
        "n": sum(map(len, mine)),
    }


def gap_closed(rows: dict[str, BySeed], rounds: int) -> dict[str, Any]:
    """(after each round - base) / (oracle - base), with the interval of the last.

    The bootstrap draws training seeds, and scenes once for all arms. None where the oracle is no
    better than the base.
    """
    names = [f"{MAIN}, round {number}" for number in range(1, rounds + 1)]
    seeds = len(rows[names[-1]])
    wide = [
        np.array(_outcomes(rows[name], seeds)) for name in ("base", "oracle", *names)
    ]  # [S, N] each.
    base, oracle, *after = (one.mean() for one in wide)
    if oracle <= base:
        return {"value": None, "interval": None, "rounds": [None] * rounds}
    rng = np.random.default_rng(0)
    shares = []
    for _ in range(DRAWS):
        drawn = rng.integers(seeds, size=seeds)
        scenes = rng.integers(wide[0].shape[1], size=wide[0].shape[1])
        low, high, top = (one[drawn][:, scenes].mean() for one in (wide[0], wide[1], wide[-1]))
        shares.append((top - low) / max(high - low, 1e-9))
    lower, upper = np.percentile(shares, [2.5, 97.5])
    return {
        "value": round((after[-1] - base) / (oracle - base), 4),
        "interval": [round(float(lower), 4), round(float(upper), 4)],
        "rounds": [round((one - base) / (oracle - base), 4) for one in after],
    }


def _corrections_share(paces: Sequence[Pace]) -> dict[str, Any]:
    """Overrides per 100 decisions of the collected episodes, over all rounds and by round."""
    efforts = [pace.efforts for pace in paces if pace.person == MAIN]
    by_round = [_per_hundred(some) for some in zip(*efforts, strict=True)]
    every = [effort for some in efforts for effort in some]
    return {"value": _per_hundred(every), "rounds": by_round}


def _per_hundred(efforts: Sequence[Effort]) -> float:
    said = sum(effort.overrides for effort in efforts)
    return round(100 * said / max(1, sum(effort.decisions for effort in efforts)), 2)


def _retention(tried: Tried, last: str) -> dict[str, Any]:
    """Success in the lab, where nobody corrected, after the last round less before the first.

    unseen: here, on prompts that were never corrected in any round, after and before.
    """
    gap = _less(tried.lab["last"], tried.lab["base"])
    pairs = [
        (mine.success, before.success)
        for rows, prompts in zip(tried.rows[last], tried.prompts, strict=True)
        for mine, before in zip(rows, tried.rows["base"][0], strict=True)
        if mine.prompt not in prompts
    ]
    return {
        "lab": gap,
        "before": _arm(tried.lab["base"]),
        "after": _arm(tried.lab["last"]),
        "unseen": {
            "after": rate([mine for mine, _ in pairs]),
            "before": rate([before for _, before in pairs]),
        },
    }


def _people(paces: Sequence[Pace]) -> list[dict[str, Any]]:
    """By round, over the training seeds."""
    rounds = []
    for efforts in zip(*(pace.efforts for pace in paces), strict=True):
        episodes = sum(effort.episodes for effort in efforts)
        said = sum(effort.overrides + effort.releases for effort in efforts)
        rounds.append(
            {
                "episodes": episodes,
                "decisions": sum(effort.decisions for effort in efforts),
                "overrides": sum(effort.overrides for effort in efforts),
                "releases": sum(effort.releases for effort in efforts),
                "corrections_per_episode": round(
                    sum(effort.overrides for effort in efforts) / max(1, episodes), 2
                ),
                "per_100_decisions": _per_hundred(efforts),
                "speaking_s": round(said * SPEAK_S / len(paces), 1),
                "watching_s": round(sum(effort.steps for effort in efforts) / HZ / len(paces), 1),
                "success_with_help": rate_of(efforts),
            }
        )
    return rounds


def rate_of(efforts: Sequence[Effort]) -> float:
    """Success of the collected episodes, with the person's help."""
    episodes = sum(effort.episodes for effort in efforts)
    return round(sum(effort.successes for effort in efforts) / max(1, episodes), 4)


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


def _staleness(settings: DaggerSettings) -> list[dict[str, int]]:
    """Of the episodes that each round learns from: how many by how many versions ago they ran."""
    return [
        {str(age): settings.episodes for age in range(number)}
        for number in range(1, settings.rounds + 1)
    ]


# -- for people


def _method(settings: DaggerSettings) -> tuple[str, ...]:
    return (
        f"{settings.rounds} rounds of {settings.episodes} episodes, {settings.seeds} training "
        "seeds with scenes of their own. A scripted person knows the true state and looks at every "
        "decision. Where the command is wrong they say the right one, which holds until they "
        "say another or let go; where it is right they say nothing, and nothing is learned.",
        "After each round the high level is trained on demonstrations from the lab and on all "
        "corrections so far; the low level never changes. Every version is tried alone, on the "
        "same scenes, that nobody corrected in.",
        "The arms are trained from the base in one go, on what the three rounds collected or on "
        "what stands in its place; `together` is the same without any change.",
    )


def _notes(settings: DaggerSettings) -> tuple[str, ...]:
    notes = [
        "Intervals of rates are Wilson's, which take all episodes as independent; those of "
        "differences and of the gap are by bootstrap over training seeds and scenes. p is "
        "McNemar's, exact, for each training seed; the largest is told. None is corrected for "
        "there being several.",
        f"Speaking is reckoned as {SPEAK_S:.0f} s an utterance, a release included; watching is "
        "the robot's time. By hand somebody drives all the time that an episode takes; the "
        "scripted expert does so without a pause.",
        "Retention is success in the lab, where no correction came from.",
    ]
    if settings.seeds == 1:
        notes.append("One training seed: this says nothing of others.")
    return tuple(notes)


def title_of(name: str) -> str:
    """An arm as people read it."""
    return ARMS[name].title if name in ARMS else name


def _arms_table(figures: dict[str, Any], last: str) -> Table:
    rows = [
        (
            title_of(name),
            cell(found),
            str(found["n"]),
            ", ".join(f"{one['success']:.2f}" for one in found["seeds"]),
            "" if name == last else gap_cell(figures["less"][name]),
        )
        for name, found in figures["arms"].items()
    ]
    columns = ("arm", "success (95 %)", "n", "by training seed", f"{last} less this")
    return Table(title="Success", columns=columns, rows=tuple(rows))


def _rounds_table(figures: dict[str, Any]) -> Table:
    rows = [
        (
            person,
            str(number),
            str(found["episodes"]),
            f"{found['corrections_per_episode']:.1f}",
            f"{found['per_100_decisions']:.1f}",
            f"{found['speaking_s'] / 60:.1f}",
            f"{found['watching_s'] / 60:.1f}",
            f"{found['success_with_help']:.2f}",
        )
        for person, rounds in figures["people"].items()
        for number, found in enumerate(rounds, 1)
    ]
    columns = (
        "person", "round", "episodes", "corrections an episode", "per 100 decisions",
        "min speaking", "min watching", "success with help",
    )  # fmt: skip
    return Table(title="What people did", columns=columns, rows=tuple(rows))


def _tasks_table(figures: dict[str, Any]) -> Table:
    tasks = sorted({task for found in figures["arms"].values() for task in found["tasks"]})
    rows = [
        (title_of(name), *(cell(found["tasks"][task]) for task in tasks))
        for name, found in figures["arms"].items()
    ]
    return Table(title="By task", columns=("arm", *tasks), rows=tuple(rows))


def _failures_table(rows: dict[str, BySeed], last: str) -> Table:
    """What went wrong first, hand or head, before and after."""
    counts = {name: _failures(rows[name]) for name in ("base", last, "oracle")}
    kinds = sorted({kind for found in counts.values() for kind in found})
    cells = [(kind, *(f"{counts[name][kind]:.2f}" for name in counts)) for kind in kinds]
    return Table(
        title="What went wrong first, share of all episodes",
        columns=("first", *counts),
        rows=tuple(cells),
    )


def _failures(rows: BySeed) -> Counter[str]:
    every: list[Row] = [row for by_seed in rows for row in by_seed]
    found: Counter[str] = Counter(row.failure for row in every if not row.success)
    return Counter({kind: count / len(every) for kind, count in found.items()})


def _plot(figures: dict[str, Any], settings: DaggerSettings, site: str) -> Plot:
    arms = figures["arms"]
    rounds = range(1, settings.rounds + 1)
    curves: list[Curve] = []
    for person in settings.people:
        points = {0.0: arms["base"]}
        points |= {float(number): arms[f"{person}, round {number}"] for number in rounds}
        curves.append(curve(person, points))
    flat = {name: arms[name] for name in ("oracle", "live")}
    curves += [
        curve(name, {0.0: found, float(settings.rounds): found}) for name, found in flat.items()
    ]
    panels = [Panel(title=site, curves=tuple(curves))]
    controls = {title_of(name): arms[name] for name in (*settings.arms, "flat") if name in arms}
    if controls:
        points_by_name = {f"round {settings.rounds}": arms[f"{MAIN}, round {settings.rounds}"]}
        panels.append(
            Panel(title="instead", curves=(curve("arms", {**points_by_name, **controls}),))
        )
    return Plot(name="dagger", title="Success by round", x_label="rounds", panels=tuple(panels))
