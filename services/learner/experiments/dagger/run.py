"""Runs the courses, the arms beside them, and tries every version on the same scenes."""

from pathlib import Path
from typing import NamedTuple

from services.learner.baselines.policy import ArmPlan, evaluator
from services.learner.experiments.bench import Bench
from services.learner.experiments.dagger.course import Course, Effort
from services.learner.experiments.dagger.lessons import Lesson, Taught, Teacher, Teaching, slug
from services.learner.experiments.dagger.scale import ARMS, MAIN, PEOPLE, DaggerSettings
from services.learner.experiments.dagger.watching import Live, Shift, Watcher
from shared.evaluation.attempts import Row
from shared.evaluation.plan import ORACLE, Case
from shared.evaluation.rows import Rows, measure
from shared.policies.checkpoint import CARD_FILE, bundled, load_card
from shared.rollout.settings import RolloutSettings

LAB = "lab"
BySeed = list[list[Row]]
"""Rows by training seed; one alone where nothing was trained."""


class Pace(NamedTuple):
    """What people did in the rounds of one course; staleness: see `Course`, by round."""

    person: str
    seed: int
    efforts: tuple[Effort, ...]
    staleness: tuple[dict[str, int], ...]


class Tried(NamedTuple):
    """All that was found.

    rows: by the arm's name. lab: the same of the base and of the last version, in the lab.
    prompts: that were corrected, by training seed. taught: what was trained.
    """

    rows: dict[str, BySeed]
    lab: dict[str, BySeed]
    paces: list[Pace]
    prompts: list[frozenset[str]]
    taught: list[Taught]


class Run:
    """One run of the experiment at a bench."""

    def __init__(self, bench: Bench, teaching: Teaching) -> None:
        self._bench, self._teaching = bench, teaching
        self._settings = teaching.settings
        self._seeds = range(teaching.settings.seeds)
        high_level = bench.plan(high_level=bench.high_level).high_level_folder()
        self._base: Path | None = None if bench.high_level == "base" else high_level
        self._courses = {
            (person, seed): teaching.course(person, seed)
            for person in self._settings.people
            for seed in self._seeds
        }

    def close(self) -> None:
        """Give the stores back."""
        for course in self._courses.values():
            course.close()

    def go(self) -> Tried:
        """Do what is missing, and tell all."""
        for course in self._courses.values():
            course.found(self._base)
        for number in range(1, self._settings.rounds + 1):
            self._collect(number)
            self._train(number)
        taught = self._arms()
        rows = self._everywhere()
        lab = {"base": self._plain("base", site=LAB), "last": self._last(LAB)}
        rounds = range(1, self._settings.rounds + 1)
        paces = [
            Pace(
                person,
                seed,
                tuple(course.effort(number) for number in rounds),
                tuple(course.staleness(number) for number in rounds),
            )
            for (person, seed), course in self._courses.items()
        ]
        prompts = [
            self._courses[MAIN, seed].corrected_prompts(self._settings.rounds)
            for seed in self._seeds
        ]
        return Tried(rows, lab, paces, prompts, taught)

    # -- rounds

    def _collect(self, number: int) -> None:
        tasks = tuple(self._bench.tasks())
        work = {
            key: course.missing(number, self._settings.episodes, tasks)
            for key, course in self._courses.items()
        }
        tell = self._bench.reporter(f"round {number}: episodes", sum(map(len, work.values())))
        for (person, seed), turns in work.items():
            course = self._courses[person, seed]
            shift = Shift(
                plan=self._bench.plan(high_level=str(course.version(number - 1))),
                person=PEOPLE[person].model_copy(update={"seed": seed}),
            )
            for watched in self._bench.pool.work(Watcher, shift, turns):
                course.add(watched)
                tell()

    def _train(self, number: int) -> None:
        rounds = {
            key: round_
            for key, course in self._courses.items()
            if (round_ := course.begin(number, self._settings.recipe))
        }
        lessons = [Lesson(person, seed, number) for person, seed in rounds]
        taught = self._bench.pool.work(Teacher, self._teaching, lessons)
        for done in self._bench.told(f"round {number}: training", taught, len(lessons)):
            key = done.lesson.person, done.lesson.seed
            assert done.candidate is not None  # A round makes one.
            self._courses[key].end(rounds[key], done.candidate)

    def _arms(self) -> list[Taught]:
        """Train the arms that are not there yet."""
        lessons = [
            Lesson(ARMS[name].person, seed, 0, name)
            for name in self._settings.arms
            if ARMS[name].person in self._settings.people
            for seed in self._seeds
        ]
        rows = Rows(self._bench.file("arms"), Taught, self._teaching.model_dump_json())
        found = measure(
            self._bench.pool, Teacher, self._teaching, lessons, lambda row: row.lesson, rows
        )
        return list(self._bench.told("arms", found, len(lessons)))

    # -- trials

    def _everywhere(self) -> dict[str, BySeed]:
        rows = {"base": self._plain("base"), "oracle": self._plain(ORACLE), "live": self._live()}
        for person in self._settings.people:
            for number in range(1, self._settings.rounds + 1):
                rows[f"{person}, round {number}"] = [
                    self._episodes(self._courses[person, seed], person, seed, number)
                    for seed in self._seeds
                ]
        for name in self._settings.arms:
            if ARMS[name].person in self._settings.people:
                rows[name] = [self._arm_rows(name, seed) for seed in self._seeds]
        if flat := self._flat():
            rows["flat"] = flat
        return rows

    def _episodes(
        self, course: Course, person: str, seed: int, number: int, site: str = ""
    ) -> list[Row]:
        site = site or self._bench.site
        plan = self._bench.plan(high_level=str(course.version(number)), site=site)
        return self._bench.episodes(f"{site}-{slug(person)}-{seed}-round-{number}", plan)

    def _last(self, site: str) -> BySeed:
        number = self._settings.rounds
        return [
            self._episodes(self._courses[MAIN, seed], MAIN, seed, number, site)
            for seed in self._seeds
        ]

    def _arm_rows(self, name: str, seed: int) -> list[Row]:
        plan = self._bench.plan(high_level=str(self._teaching.arm(name, seed)))
        return self._bench.episodes(f"{self._bench.site}-{name}-{seed}", plan)

    def _plain(self, high_level: str, site: str = "") -> BySeed:
        """Nothing is trained, so there is one."""
        site = site or self._bench.site
        wanted = self._bench.high_level if high_level == "base" else high_level
        plan = self._bench.plan(high_level=wanted, site=site)
        return [self._bench.episodes(f"{site}-{high_level}", plan)]

    def _live(self) -> BySeed:
        plan = self._bench.plan(high_level=self._bench.high_level)
        shift = Shift(plan=plan, person=PEOPLE[MAIN])
        name = f"{self._bench.site}-live"
        note = f"{plan.note()} {shift.person.model_dump_json()}"
        rows = Rows(self._bench.file(name), Row, note)
        found = measure(self._bench.pool, Live, shift, plan.cases(), _case, rows)
        told = self._bench.told(name, found, len(plan.cases()))
        return [sorted(told, key=lambda row: row.seed)]

    def _flat(self) -> BySeed:
        """The flat arm of `hld experiment baselines`, where its run is at hand."""
        folders = flat_arms(self._bench.baselines)[: self._settings.seeds]
        return [
            self._bench.episodes(
                f"{self._bench.site}-flat-{seed}", self._flat_plan(folder), evaluator
            )
            for seed, folder in enumerate(folders)
        ]

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
