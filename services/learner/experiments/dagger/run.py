"""Runs the courses, the arms beside them, and tries every version on the same scenes."""

from collections.abc import Mapping, Sequence
from contextlib import ExitStack, closing
from functools import partial
from pathlib import Path
from typing import NamedTuple

from services.learner.baselines.policy import ArmPlan, evaluator
from services.learner.experiments.bench import Bench
from services.learner.experiments.dagger.course import Course
from services.learner.experiments.dagger.kept import (
    Archive,
    BySeed,
    Outcomes,
    Pace,
    bare,
    claim,
    joined,
)
from services.learner.experiments.dagger.lessons import Lesson, Taught, Teacher, Teaching, slug
from services.learner.experiments.dagger.notes import Notes
from services.learner.experiments.dagger.scale import ARMS, LAB, MAIN, PEOPLE, DaggerSettings
from services.learner.experiments.dagger.watching import Live, Shift, Watcher
from shared.evaluation.attempts import Row
from shared.evaluation.plan import ORACLE, Case
from shared.evaluation.rows import Rows, measure
from shared.policies.checkpoint import CARD_FILE, bundled, load_card
from shared.rollout.settings import RolloutSettings

LAB_ARMS = ("together", "unanchored", "as-fast", "untoned", "rehearsed")
"""Tried in the lab, too: what keeps what was known there."""


class Tried(NamedTuple):
    """All that was found.

    rows: by the arm's name. lab: the same in the lab, of the base, the last version, `LAB_ARMS`.
    prompts: that were corrected, by training seed. taught: what was trained.
    """

    rows: dict[str, BySeed]
    lab: dict[str, BySeed]
    paces: list[Pace]
    prompts: list[frozenset[str]]
    taught: list[Taught]


class Run:
    """One run of the experiment at a bench: what nothing was trained for, then a training seed
    after the other; see `kept`."""

    def __init__(self, bench: Bench, teaching: Teaching) -> None:
        self._bench, self._teaching = bench, teaching
        self._settings = teaching.settings
        self._notes = Notes(bench, teaching.settings)
        high_level = bench.plan(high_level=bench.high_level).high_level_folder()
        self._base: Path | None = None if bench.high_level == "base" else high_level
        self._archive = Archive(bench.out / "outcomes" / bench.site)

    def go(self) -> Tried:
        """Do what is missing, and tell all."""
        untrained = self._archive.get("untrained", self._notes.untrained(), self._untrained)
        flat = self._flat()
        each = [self._seed(seed) for seed in range(self._settings.seeds)]
        rows = {name: [some] for name, some in untrained.rows.items()}
        rows |= {name: [one.rows[name] for one in each] for name in each[0].rows}
        untrained_lab = {name: [some] for name, some in untrained.lab.items()}
        if flat:
            rows["flat"] = flat
        return Tried(
            rows=rows,
            lab=untrained_lab | {name: [one.lab[name] for one in each] for name in each[0].lab},
            paces=[pace for one in each for pace in one.paces],
            prompts=[frozenset(one.prompts) for one in each],
            taught=[taught for one in each for taught in one.taught],
        )

    def _untrained(self) -> Outcomes:
        """What is the same for each training seed."""
        rows = {"base": self._plain("base"), "oracle": self._plain(ORACLE), "live": self._live()}
        return Outcomes(
            note=self._notes.untrained(),
            rows={name: bare(some) for name, some in rows.items()},
            lab={"base": bare(self._plain("base", LAB))},
        )

    def _seed(self, seed: int) -> Outcomes:
        """All rounds and arms of one training seed, of which each is kept by itself."""
        people, names = self._settings.people, self._settings.arms_of_people
        # What is there is held against its note first: before hours of work, not after.
        arms = [
            name for name in names if not self._archive.has(f"{name}-{seed}", self._notes.arm(name))
        ]
        new = [
            one
            for one in people
            if not self._archive.has(_file(one, seed), self._notes.rounds(one))
        ]
        # What arms learn from is there, also where its own outcomes came from elsewhere.
        learned_from = {ARMS[name].person for name in arms}
        self._courses([one for one in people if one in learned_from or one in new], seed)
        found = [
            self._archive.get(
                _file(person, seed), self._notes.rounds(person), partial(self._rounds, person, seed)
            )
            for person in people
        ]
        taught = {one.lesson.arm: one for one in self._arms(arms, seed)}
        for name in names:
            make = partial(self._arm_tried, name, seed, taught)
            found.append(self._archive.get(f"{name}-{seed}", self._notes.arm(name), make))
        return joined(found)

    def _rounds(self, person: str, seed: int) -> Outcomes:
        """What came of the rounds of one person."""
        last = self._settings.rounds
        with closing(self._teaching.course(person, seed)) as course:
            rows = {
                f"{person}, round {number}": bare(self._episodes(course, number))
                for number in self._settings.tried(person)
            }
            main = person == MAIN
            return Outcomes(
                note=self._notes.rounds(person),
                rows=rows,
                lab={"last": bare(self._episodes(course, last, LAB))} if main else {},
                paces=[self._pace(person, course)],
                prompts=sorted(course.corrected_prompts(last)) if main else [],
            )

    def _arm_tried(self, name: str, seed: int, taught: dict[str, Taught]) -> Outcomes:
        """What came of one arm."""
        in_lab = {name: bare(self._arm(name, seed, LAB))} if name in LAB_ARMS else {}
        return Outcomes(
            note=self._notes.arm(name),
            rows={name: bare(self._arm(name, seed, self._bench.site))},
            lab=in_lab,
            taught=[taught[name]],
        )

    def _pace(self, person: str, course: Course) -> Pace:
        rounds = range(1, self._settings.rounds + 1)
        efforts = tuple(course.effort(number, PEOPLE[person]) for number in rounds)
        return Pace(person, course.seed, efforts, tuple(map(course.staleness, rounds)))

    # -- rounds

    def _courses(self, people: Sequence[str], seed: int) -> None:
        """All rounds of these people's courses, but what is there of them."""
        for person in people:
            claim(self._teaching.folder(person, seed), self._notes.course(person))
        with ExitStack() as stack:
            courses = {
                person: stack.enter_context(closing(self._teaching.course(person, seed)))
                for person in people
            }
            for course in courses.values():
                course.found(self._base)
            for number in range(1, self._settings.rounds + 1):
                self._collect(courses, number)
                self._train(courses, number)

    def _collect(self, courses: Mapping[str, Course], number: int) -> None:
        tasks, places = tuple(self._bench.tasks()), self._settings.places(number)
        work = {
            person: course.missing(number, places, tasks, PEOPLE[person])
            for person, course in courses.items()
        }
        tell = self._bench.reporter(f"round {number}: episodes", sum(map(len, work.values())))
        for person, turns in work.items():
            course = courses[person]
            shift = Shift(
                plan=self._bench.plan(high_level=str(course.version(number - 1))),
                person=PEOPLE[person].model_copy(update={"seed": course.seed}),
            )
            for watched in self._bench.pool.work(Watcher, shift, turns):
                course.add(watched)
                tell()

    def _train(self, courses: Mapping[str, Course], number: int) -> None:
        rounds = {
            person: round_
            for person, course in courses.items()
            if (round_ := course.begin(number, self._settings.recipe))
        }
        lessons = [Lesson(person, courses[person].seed, number) for person in rounds]
        taught = self._bench.pool.work(Teacher, self._teaching, lessons)
        for done in self._bench.told(f"round {number}: training", taught, len(lessons)):
            assert done.candidate is not None  # A round makes one.
            person = done.lesson.person
            courses[person].end(rounds[person], done.candidate)

    def _arms(self, names: list[str], seed: int) -> list[Taught]:
        """Train these arms, from the courses that they learn from."""
        lessons = [Lesson(ARMS[name].person, seed, 0, name) for name in names]
        note = self._notes.arms(self._teaching)
        rows = Rows(self._bench.file(f"arms-{seed}"), Taught, note)
        found = measure(
            self._bench.pool, Teacher, self._teaching, lessons, lambda row: row.lesson, rows
        )
        return list(self._bench.told("arms", found, len(lessons)))

    # -- trials

    def _arm(self, name: str, seed: int, site: str) -> list[Row]:
        plan = self._bench.plan(high_level=str(self._teaching.arm(name, seed)), site=site)
        return self._bench.episodes(f"{site}-{name}-{seed}", plan)

    def _episodes(self, course: Course, number: int, site: str = "") -> list[Row]:
        site = site or self._bench.site
        plan = self._bench.plan(high_level=str(course.version(number)), site=site)
        return self._bench.episodes(f"{site}-{course.folder.name}-round-{number}", plan)

    def _plain(self, high_level: str, site: str = "") -> list[Row]:
        site = site or self._bench.site
        wanted = self._bench.high_level if high_level == "base" else high_level
        plan = self._bench.plan(high_level=wanted, site=site)
        return self._bench.episodes(f"{site}-{high_level}", plan)

    def _live(self) -> list[Row]:
        plan = self._bench.plan(high_level=self._bench.high_level)
        shift = Shift(plan=plan, person=PEOPLE[MAIN])
        name = f"{self._bench.site}-live"
        note = f"{plan.note()} {shift.person.model_dump_json()}"
        rows = Rows(self._bench.file(name), Row, note)
        found = measure(self._bench.pool, Live, shift, plan.cases(), _case, rows)
        told = self._bench.told(name, found, len(plan.cases()))
        return sorted(told, key=lambda row: row.seed)

    def _flat(self) -> BySeed:
        """The flat arm of `hld experiment baselines`, where its run is at hand or was."""
        folders = flat_arms(self._bench.baselines)
        found = []
        for seed in range(self._settings.seeds):
            name = f"flat-{seed}"
            if seed < len(folders) or self._archive.has(name, self._notes.untrained()):
                make = partial(self._flat_of, folders, seed)
                made = self._archive.get(name, self._notes.untrained(), make)
                found.append(made.rows["flat"])
        return found

    def _flat_of(self, folders: list[Path], seed: int) -> Outcomes:
        plan = self._flat_plan(folders[seed])
        rows = self._bench.episodes(f"{self._bench.site}-flat-{seed}", plan, evaluator)
        return Outcomes(note=self._notes.untrained(), rows={"flat": bare(rows)})

    def _flat_plan(self, folder: Path) -> ArmPlan:
        rollout = RolloutSettings()
        return ArmPlan(
            site=self._bench.site,
            seeds=self._bench.seeds,
            tasks=tuple(self._bench.tasks()),
            high_level=str(folder),
            low_level=str(folder),
            rollout=rollout.model_copy(update={"decision_steps": rollout.execute_steps}),
        )


def _file(person: str, seed: int) -> str:
    """The name of what came of a person's rounds."""
    return f"{slug(person)}-{seed}"


def flat_arms(folder: Path | None) -> list[Path]:
    """The checkpoints of the flat arm in a run of the baselines, by training seed."""
    if folder is None:
        return []
    return sorted(card.parent for card in folder.glob(f"fits-*/flat-*/{CARD_FILE}"))


def teaching_of(bench: Bench, settings: DaggerSettings) -> Teaching:
    """What the pool is told."""
    folder = Path(bench.low_level) if bench.low_level else bundled("low_level")
    return Teaching(
        out=bench.out / "courses" / bench.site,
        settings=settings,
        low_level_sha256=load_card(folder).tensors_sha256,
        site=bench.site,
    )


def _case(row: Row) -> Case:
    return Case(row.seed, row.task)
