"""The report of the rounds for people: tables, a picture, and what one must know to read them."""

from collections.abc import Sequence
from typing import Any

from services.learner.experiments.dagger.figures import SPEAK_S, figures_of
from services.learner.experiments.dagger.run import Tried
from services.learner.experiments.dagger.scale import ARMS, LAB, MAIN, PEOPLE, DaggerSettings
from services.learner.experiments.dagger.targets import targets_table
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

MOST_COMMANDS = 12
FEWEST_POINTS = 2

ENDORSING = (
    " After an episode that succeeded they say once that the rest was right, so that what π_HL "
    "chose there is learned, too, but not what they may have begun to object to."
)
REVIEWING = (
    " From the second round on every other episode is left to the robot: afterwards they say of "
    "each wrong stretch what would have been right, and that the rest was."
)


def findings(settings: DaggerSettings, tried: Tried, site: str) -> Findings:
    """What came out, told for machines and for people."""
    last, figures = f"{MAIN}, round {settings.rounds}", figures_of(settings, tried, site)
    return Findings(
        title="Do corrections help, and is it the corrections?",
        method=_method(settings),
        figures=figures,
        first=("arms", "gap_closed", "corrections_share", "retention"),
        tables=(
            targets_table(figures, settings.rounds),
            _arms_table(figures, last),
            _rounds_table(figures),
            _kept_table(figures),
            *_driven_tables(figures),
            _tasks_table(figures),
            _failures_table(figures),
            _commands_table(figures),
            _staleness_table(figures),
        ),
        plots=(_plot(figures, settings, site), *_amounts(figures, settings, site)),
        notes=_notes(settings, site, flat="flat" in tried.rows),
    )


def _method(settings: DaggerSettings) -> tuple[str, ...]:
    seeds = "one training seed" if settings.seeds == 1 else f"{settings.seeds} training seeds"
    return (
        f"{settings.rounds} rounds, of {_listed(settings.episodes)} episodes, {seeds} "
        "with scenes of their own. A scripted person knows the true state and looks "
        "at every decision. Where the command is wrong they say the right one, which holds until "
        "they say another or let go; where it is right they say nothing."
        + (ENDORSING if PEOPLE[MAIN].endorse else " Nothing is learned there.")
        + (REVIEWING if PEOPLE[MAIN].review_every else ""),
        "After each round the high level is trained on demonstrations from the lab and on all "
        "corrections so far; the low level never changes. Every version is tried alone, on the "
        "same scenes, that nobody corrected in.",
        "The arms are trained from the base in one go, on what the three rounds collected or on "
        "what stands in its place; `together` is the same without any change.",
    )


def _listed(counts: Sequence[int]) -> str:
    return ", ".join(map(str, counts))


def _notes(settings: DaggerSettings, site: str, *, flat: bool) -> tuple[str, ...]:
    notes = [
        "Intervals of rates are Wilson's, which take all episodes as independent; those of "
        "differences and of the gap are by bootstrap over training seeds and scenes. p is "
        "McNemar's, exact, for each training seed; the largest is told. None is corrected for "
        "there being several.",
        "A correction is what somebody says: an override, which may hold over several decisions, "
        "what would have been right over a stretch, or an endorsement of an episode. A release is "
        "a key without words, and is counted beside. "
        f"Speaking is reckoned as {SPEAK_S:.0f} s an utterance, a release included; watching is "
        "the robot's time. By hand somebody drives all the time that an episode takes; the "
        "scripted expert does so without a pause.",
        "An arm with fewer labels is trained by fewer updates, as a round is, but by as many where "
        "shares are compared.",
        "The last round alone is learned from the base, not from the version before it with what "
        "came before counted as demonstrations, as the published code has it.",
        "Retention is success in the lab, where no correction came from."
        if site != LAB
        else "Corrections came from the lab itself, so that what is told of it is no retention; "
        "demonstrations at the site are those in the lab, and no arm of their own.",
        "Of prompts that nobody corrected the interval is Newcombe's, over the pairs of all "
        "training seeds, which it takes as independent.",
    ]
    if not flat:
        notes.append(
            "The flat arm was not at hand: `hld experiment baselines` trains it, and --baselines "
            "names its folder."
        )
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
            f"{figures['learned_from'][name]['labels']:.0f}" if name in ARMS else "",
            "" if name == last else gap_cell(figures["less"][name]),
        )
        for name, found in figures["arms"].items()
    ]
    columns = (
        "arm", "success (95 %)", "n", "by training seed", "labels", f"{last} less this",
    )  # fmt: skip
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
            *(
                "" if found[share] is None else f"{found[share]:.2f}"
                for share in ("success_with_help", "success_alone")
            ),
        )
        for person, rounds in figures["people"].items()
        for number, found in enumerate(rounds, 1)
    ]
    columns = (
        "person", "round", "episodes", "corrections an episode", "per 100 decisions",
        "min speaking", "min watching", "success with help", "success alone",
    )  # fmt: skip
    return Table(title="What people did", columns=columns, rows=tuple(rows))


def _kept_table(figures: dict[str, Any]) -> Table:
    """What it knew before."""
    kept, unseen = figures["retention"], figures["retention"]["unseen"]
    return Table(
        title="What was never corrected",
        columns=("", "before", "after", "after less before"),
        rows=(
            ("the lab", cell(kept["before"]), cell(kept["after"]), gap_cell(kept["lab"])),
            *(
                (f"the lab: {title_of(name)}", "", cell(found), gap_cell(found["less"]))
                for name, found in kept["arms"].items()
            ),
            ("prompts that nobody corrected", *_unseen(unseen)),
        ),
    )


def _unseen(found: dict[str, Any]) -> tuple[str, str, str]:
    if found["less"] is None:
        return ("no such scene", "", "")
    return (cell(found["before"]), cell(found["after"]), gap_cell(found["less"]))


def _driven_tables(figures: dict[str, Any]) -> tuple[Table, ...]:
    """What as many decisions by hand take, where such arms were run."""
    rows = [
        (title_of(name), str(found["decisions"]), f"{found['minutes']:.1f}")
        for name, found in figures["teleoperation"].items()
    ]
    columns = ("arm", "decisions", "min driving")
    table = Table(
        title="Demonstrations by hand, a training seed", columns=columns, rows=tuple(rows)
    )
    return (table,) if rows else ()


def _tasks_table(figures: dict[str, Any]) -> Table:
    tasks = sorted({task for found in figures["arms"].values() for task in found["tasks"]})
    rows = [
        (title_of(name), *(cell(found["tasks"][task]) for task in tasks))
        for name, found in figures["arms"].items()
    ]
    return Table(title="By task", columns=("arm", *tasks), rows=tuple(rows))


def _failures_table(figures: dict[str, Any]) -> Table:
    """What went wrong first, hand or head, before and after."""
    counts = figures["failures"]
    kinds = sorted({kind for found in counts.values() for kind in found})
    cells = [(kind, *(f"{counts[name].get(kind, 0.0):.2f}" for name in counts)) for kind in kinds]
    return Table(
        title="What went wrong first, share of all episodes",
        columns=("first", *counts),
        rows=tuple(cells),
    )


def _commands_table(figures: dict[str, Any]) -> Table:
    """Under which commands, after the last round."""
    rows = [
        (one["command"] or "none yet", one["failure"], str(one["count"]), f"{one['share']:.3f}")
        for one in figures["failed_commands"][:MOST_COMMANDS]
    ]
    columns = ("command", "what went wrong first", "episodes", "share of all")
    return Table(title="Commands that failed first", columns=columns, rows=tuple(rows))


def _staleness_table(figures: dict[str, Any]) -> Table:
    """How old the versions were that ran the episodes a round learned from."""
    rounds = figures["staleness"]
    ages = sorted({age for found in rounds for age in found}, key=int)
    return Table(
        title="Episodes learned from, by how many versions ago they ran",
        columns=("round", *ages),
        rows=tuple(
            (str(number), *(str(found.get(age, 0)) for age in ages))
            for number, found in enumerate(rounds, 1)
        ),
    )


def _amounts(figures: dict[str, Any], settings: DaggerSettings, site: str) -> tuple[Plot, ...]:
    """Success over how many corrections were learned from, where arms learned from fewer."""
    names = [
        name for name in settings.arms_of_people if ARMS[name].episodes < 1.0 or name == "together"
    ]
    if len(names) < FEWEST_POINTS:
        return ()
    points = {0.0: figures["arms"]["base"]}
    for name in sorted(names, key=lambda name: ARMS[name].episodes):
        points[figures["learned_from"][name]["corrections"]] = figures["arms"][name]
    panel = Panel(title=site, curves=(curve("learned at once", points),))
    title, label = "Success by corrections", "corrections learned from"
    return (Plot(name="corrections", title=title, x_label=label, panels=(panel,)),)


def _plot(figures: dict[str, Any], settings: DaggerSettings, site: str) -> Plot:
    arms = figures["arms"]
    curves: list[Curve] = []
    for person in settings.people:
        points = {0.0: arms["base"]}
        for number in settings.tried(person):
            points[float(number)] = arms[f"{person}, round {number}"]
        curves.append(curve(person, points))
    flat = {name: arms[name] for name in ("oracle", "live")}
    curves += [
        curve(name, {0.0: found, float(settings.rounds): found}) for name, found in flat.items()
    ]
    panels = [Panel(title=site, curves=tuple(curves))]
    # By their short names: whole titles don't fit beside one another.
    controls = {name: arms[name] for name in (*settings.arms, "flat") if name in arms}
    if controls:
        points_by_name = {f"round {settings.rounds}": arms[f"{MAIN}, round {settings.rounds}"]}
        panels.append(
            Panel(
                title="and what it is compared with",
                curves=(curve("arms", {**points_by_name, **controls}),),
                x_label="arm",
            )
        )
    return Plot(name="dagger", title="Success by round", x_label="rounds", panels=tuple(panels))
