"""What came of the baselines: rates by length, paired differences, and that means were equal."""

from collections import defaultdict
from typing import Any

from services.learner.baselines.scale import TITLES, BaselineSettings
from services.learner.baselines.work import Trained
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
from shared.errors import HldError
from shared.evaluation.attempts import Row
from shared.evaluation.plan import ORACLE
from shared.evaluation.summary import summarize
from shared.intervals import mcnemar, rate, seeds_difference

OTHERS = ("flat", "chain", "latent", "guided", ORACLE)
"""What the hierarchy is compared with; the oracle above it has its own hand: what is missing to
that is what a better head would bring."""
Outcomes = list[list[bool]]
"""By training seed and scene."""


def findings(
    settings: BaselineSettings,
    trained: list[Trained],
    rows: dict[int, dict[str, list[list[Row]]]],
    site: str,
) -> Findings:
    """rows: by length, arm and training seed."""
    outcomes = {
        length: {arm: _outcomes(by_seed) for arm, by_seed in by_arm.items()}
        for length, by_arm in rows.items()
    }
    figures = {
        "settings": settings.model_dump(mode="json"),
        "data_sha256": _only({row.data_sha256 for row in trained}),
        "training": _training(trained),
        "lengths": {length: _figures(by_arm) for length, by_arm in rows.items()},
        "hierarchy_less": {
            arm: {
                **{str(length): _less(by_arm, arm) for length, by_arm in outcomes.items()},
                "all": _less(_over_lengths(outcomes), arm),
            }
            for arm in OTHERS
        },
    }
    return Findings(
        title="Baselines on equal data",
        method=_method(settings),
        figures=figures,
        tables=(_by_length(figures), _differences(figures), _means(figures)),
        plots=(
            Plot(
                name="baselines",
                title=f"Success over the horizon, {site}",
                x_label="skills that the prompt takes",
                panels=(Panel(title="equal data", curves=tuple(_curves(figures))),),
            ),
        ),
        notes=_notes(settings, outcomes),
    )


def _method(settings: BaselineSettings) -> tuple[str, ...]:
    data, fit = settings.data, settings.fit
    return (
        f"{data.episodes} episodes of the scripted expert in the lab, shaky and with slips, are "
        f"what every arm learns from, by {fit.steps:,} updates of {fit.batch} looks, "
        f"{settings.rows} rows of the low level's for each, with one optimizer, and with the same "
        "witnesses of where things are and of what prompts mean.",
        "All have one network, a trunk that sees and reads and a mover. In the hierarchy only a "
        "command passes between them, learned from labels. The chain of thought says the command, "
        "too, and passes on something of its thought; both losses train it as one. Latent goals "
        "have no labels: a vector and a soft pointer take the command's place, renewed every 20 "
        "steps, trained by the actions alone. Flat is the same, renewed with every chunk of 5 "
        "steps, without earlier looks.",
        "Under the oracle the hierarchy's mover is told what is right. Every arm is tried on the "
        "same scenes, as `hld evaluate` judges them.",
    )


def _notes(settings: BaselineSettings, outcomes: dict[int, dict[str, Outcomes]]) -> tuple[str, ...]:
    notes = [
        "Intervals of differences are by bootstrap over training seeds and scenes, and say what "
        "holds for another training seed; those of rates are Wilson's, which take all episodes as "
        "independent.",
        "p is McNemar's, exact, two-sided, of one training seed: in pairs of several a scene would "
        "count once for each, as if it were another. The largest is shown, all are in the JSON. "
        "None is corrected for there being several.",
        "Every arm's policies come from these demonstrations alone, none of the project's own.",
        "Progress is how much of what the prompt asks for was in place at the end, a mean.",
        "An arm that says commands is helped by what the rollout knows of them: what the low level "
        "can't carry out at that moment is not taken (`LowLevel.can`, with the project's reader). "
        "Arms without words have no such filter.",
        "Flat and latent goals learn from actions alone, without the labels that the other two "
        "have: that is what they are without words. Flat sees no earlier looks either.",
        "Latent goals with labels besides are a control, on the same network, data and updates. "
        "Its vector is a phrase's, the right one's while it learns, the likeliest one's when it "
        "acts; labels also teach where it points, softly. Where it succeeds, that latent goals "
        "don't is no fault of mover, pointer or rollout; where it doesn't, it may be one.",
    ]
    if settings.seeds == 1:
        notes.append("One training seed: this says nothing of others.")
    reached = {
        arm for arms in outcomes.values() for arm, found in arms.items() if any(map(any, found))
    }
    never = [title for arm, title in TITLES.items() if arm not in reached]
    if never:
        notes.append(f"Never succeeded at this scale: {', '.join(never)}.")
    return tuple(notes)


def _only(hashes: set[str]) -> str:
    """The one that all have.

    Raises:
        HldError: they don't learn from the same data.
    """
    if len(hashes) != 1:
        raise HldError(
            f"the arms learned from different demonstrations ({', '.join(sorted(hashes))}): "
            "begin anew with another --out"
        )
    return hashes.pop()


def _outcomes(by_seed: list[list[Row]]) -> list[list[bool]]:
    return [[row.success for row in rows] for rows in by_seed]


def _training(trained: list[Trained]) -> dict[str, Any]:
    """What each arm had and took, over all training seeds; losses at the end."""
    by_arm = defaultdict[str, list[Trained]](list)
    for row in trained:
        by_arm[row.arm].append(row)
    return {arm: _took(rows) for arm, rows in by_arm.items()}


def _took(rows: list[Trained]) -> dict[str, Any]:
    last = max(row.until for row in rows)
    ends = [row for row in rows if row.until == last]
    return {
        "parameters": ends[0].parameters,
        "updates": last,
        "cpu_s_per_update": round(
            sum(row.cpu_s for row in rows) / max(1, sum(row.updates for row in rows)), 4
        ),
        "action_loss": [round(row.moved, 4) for row in ends],
        "goal_loss": [round(row.goal, 4) for row in ends],
        "agreement": [round(row.agreement, 4) for row in ends],
    }


def _figures(by_arm: dict[str, list[list[Row]]]) -> dict[str, Any]:
    found = {}
    for arm, by_seed in by_arm.items():
        every = [row for rows in by_seed for row in rows]
        summary = summarize(every)
        found[arm] = {
            **rate([row.success for row in every]),
            "by_seed": [rate([row.success for row in rows]) for rows in by_seed],
            "progress": summary["progress"],
            "steps": summary["steps"],
            "failures": summary["failures"],
            "tasks": {
                task: rate([row.success for row in every if row.task == task])
                for task in summary["tasks"]
            },
        }
    return found


def _over_lengths(outcomes: dict[int, dict[str, Outcomes]]) -> dict[str, Outcomes]:
    """Of each arm the scenes of all lengths one after another."""
    arms = list(outcomes.values())
    return {
        arm: [
            [won for by_arm in arms for won in by_arm[arm][seed]]
            for seed in range(len(arms[0][arm]))
        ]
        for arm in arms[0]
    }


def _less(by_arm: dict[str, Outcomes], other: str) -> dict[str, Any]:
    """How much better the hierarchy is, on the same scenes and training seeds; p: of each seed."""
    mine, its = by_arm["hierarchy"], by_arm[other]
    gap = seeds_difference(mine, its)
    return {
        "difference": round(gap.value, 4),
        "interval": [round(gap.low, 4), round(gap.high, 4)],
        "p": [round(mcnemar(*pair), 4) for pair in zip(mine, its, strict=True)],
        "n": sum(map(len, mine)),
    }


def _curves(figures: dict[str, Any]) -> list[Curve]:
    lengths = figures["lengths"]
    return [
        curve(title, {float(length): found[arm] for length, found in lengths.items()})
        for arm, title in TITLES.items()
    ]


def _by_length(figures: dict[str, Any]) -> Table:
    rows = [
        (
            str(length),
            TITLES[arm],
            cell(found),
            str(found["n"]),
            ", ".join(f"{one['success']:.2f}" for one in found["by_seed"]),
            f"{found['progress']:.2f}",
            f"{found['steps']:.0f}",
            ", ".join(f"{name} {count}" for name, count in found["failures"].items()),
        )
        for length, by_arm in figures["lengths"].items()
        for arm, found in by_arm.items()
    ]
    columns = (
        "skills", "arm", "success (95 %)", "n", "by training seed", "progress", "steps",
        "failed first",
    )  # fmt: skip
    return Table(title="Success by length", columns=columns, rows=tuple(rows))


def _differences(figures: dict[str, Any]) -> Table:
    rows = [
        (TITLES[arm], length, gap_cell({**found, "p": max(found["p"])}), str(found["n"]))
        for arm, by_length in figures["hierarchy_less"].items()
        for length, found in by_length.items()
    ]
    columns = ("hierarchy less", "skills", "difference (95 %), largest p of a seed", "pairs")
    return Table(title="The hierarchy against the others", columns=columns, rows=tuple(rows))


def _means(figures: dict[str, Any]) -> Table:
    rows = [
        (
            TITLES[arm],
            f"{found['parameters']:,}",
            f"{found['updates']:,}",
            f"{found['cpu_s_per_update']:.3f}",
            ", ".join(f"{loss:.3f}" for loss in found["action_loss"]),
            ", ".join(f"{share:.2f}" for share in found["agreement"])
            if any(found["goal_loss"])
            else "",
        )
        for arm, found in figures["training"].items()
    ]
    columns = (
        "arm", "parameters that learn", "updates", "CPU s an update", "action loss",
        "commands told rightly",
    )  # fmt: skip
    return Table(title="Equal means", columns=columns, rows=tuple(rows))
