"""The bench that an experiment works at: episodes and phrases, on all cores, done only once."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Protocol, TypeVar

from services.learner.experiments.findings import Findings
from shared.evaluation.attempts import Row
from shared.evaluation.episode import Evaluator
from shared.evaluation.evaluate import evaluate
from shared.evaluation.phrase import Phrases, Said, Speaker, Trial
from shared.evaluation.plan import Plan
from shared.evaluation.pool import Pool
from shared.evaluation.rows import Rows, measure
from shared.seeds import EVALUATION
from shared.workcell.tasks import TASKS

R = TypeVar("R")


class Reporter(Protocol):
    """Where progress is told."""

    def __call__(self, name: str, total: int) -> Callable[[], None]:
        """Begin something; the answer is to be called for each part of `total` that is done."""
        ...


class Scale(StrEnum):
    """small: to try it, rather than to learn from it. core: what matters most, where an experiment
    tells that apart. full: everything."""

    SMALL = "small"
    CORE = "core"
    FULL = "full"


@dataclass(frozen=True)
class Bench:
    """What an experiment is given.

    out: where rows are kept, by the name of what was measured; what lies there isn't done again.
    seeds: from A up to B, as in `Plan`; the scenes of each cell of a table.
    high_level: the learned one, as `Plan` takes it. low_level: checkpoint folder, as there.
    baselines: folder of a run of the baselines, where there is one to be compared with.
    publish: takes what was found so far, where a part of it makes a report already.
    """

    out: Path
    pool: Pool
    reporter: Reporter
    seeds: tuple[int, int]
    scale: Scale = Scale.FULL
    site: str = "lab"
    high_level: str = "base"
    low_level: str = ""
    baselines: Path | None = None
    publish: Callable[[Findings], None] = lambda _: None

    @property
    def small(self) -> bool:
        """Whether it is only to be tried."""
        return self.scale is Scale.SMALL

    @property
    def n(self) -> int:
        """How many scenes there are."""
        return self.seeds[1] - self.seeds[0]

    def seed(self, number: int) -> int:
        """The seed of one of them."""
        return EVALUATION.start + self.seeds[0] + number % self.n

    def plan(self, **changes: object) -> Plan:
        """A plan at this bench's site with its seeds and low level, unless told otherwise."""
        given = {"site": self.site, "seeds": self.seeds, "low_level": self.low_level}
        return Plan.model_validate({**given, **changes})

    def episodes(
        self, name: str, plan: Plan, make: Callable[[Plan], Evaluator] = Evaluator
    ) -> list[Row]:
        """One episode a seed, ordered by their seeds, so that two plans' rows make pairs.

        make: as for `evaluate`.
        Raises:
            HldError: the plan can't work.
        """
        plan.check()
        rows = evaluate(plan, self.pool, self.file(name), make)
        return sorted(self.told(name, rows, len(plan.cases())), key=lambda row: row.seed)

    def phrases(self, name: str, trials: Sequence[Trial], site: str = "") -> list[Said]:
        """What came of each trial, in their order."""
        plan = Phrases(site=site or self.site, low_level=self.low_level)
        trials = list(dict.fromkeys(trials))
        rows = Rows(self.file(name), Said, plan.note())
        found = measure(self.pool, Speaker, plan, trials, lambda said: said.trial, rows)
        by_trial = {said.trial: said for said in self.told(name, found, len(trials))}
        return [by_trial[trial] for trial in trials]

    def tasks(self, skills: int | None = None) -> list[str]:
        """The tasks whose prompts can take so many skills."""
        return [name for name, task in TASKS.items() if skills is None or skills in task.lengths]

    def file(self, name: str) -> Path:
        """Where rows of this name are kept."""
        return self.out / "rows" / f"{name}.jsonl"

    def told(self, name: str, rows: Iterable[R], total: int) -> Iterable[R]:
        """The same rows, each of them told as it comes."""
        tell = self.reporter(name, total)
        for row in rows:
            tell()
            yield row


def slug(high_level: str) -> str:
    """A high level as a part of a name."""
    return "".join(sign if sign.isalnum() or sign in ".-" else "-" for sign in high_level).strip(
        "-"
    )
