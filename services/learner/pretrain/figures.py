"""The last stage: both levels are examined, and their cards get the figures."""

from collections.abc import Sequence
from pathlib import Path

from services.learner.pretrain import cards
from services.learner.pretrain.exam import Exam, Tried, by_name, figure, try_skills
from services.learner.pretrain.reading_exam import final
from services.learner.pretrain.reading_figures import HEARD, UNHEARD
from services.learner.pretrain.stages import EXAM_SEED, PARTS, Pretraining
from services.learner.pretrain.unheard import unheard_phrases
from shared.evaluation.attempts import Row
from shared.evaluation.episode import Evaluator
from shared.evaluation.plan import ORACLE, Case, Plan
from shared.policies import checkpoint
from shared.policies.checkpoint import Figure
from shared.policies.low_level import LowLevel
from shared.workcell.skills import COMMANDS

SITES = ("lab", "near", "far")
QUESTIONS = 2
"""Of a kind about each thing, to measure the reading of phrases."""


def examine(pretraining: Pretraining, low_level: Path, high_level: Path) -> None:
    """Write `low_level` and `high_level` in the output folder, with figures on their cards."""
    skills = _skills(pretraining, low_level)
    tasks = _tasks(pretraining, low_level)
    _publish(low_level, pretraining.out / "low_level", [*skills, *tasks, *reading(low_level)])
    trials = _trials(pretraining, low_level, high_level)
    _publish(high_level, pretraining.out / "high_level", trials)


def _publish(source: Path, target: Path, figures: Sequence[Figure]) -> None:
    tensors, card = checkpoint.load(source)
    checkpoint.save(target, tensors, cards.examined(card, figures))


def _skills(pretraining: Pretraining, low_level: Path) -> list[Figure]:
    """Each skill in the lab, by the canonical commands and by paraphrases never trained on."""
    unheard = [tuple(one.phrase for one in told) for told in unheard_phrases()]
    held_out = dict(zip(COMMANDS, unheard, strict=True))
    figures = []
    for said, words in (("", {}), (", unheard paraphrases", held_out)):
        seeds = _pieces(EXAM_SEED, pretraining.scale.chains)
        exams = [Exam(low_level, "lab", piece, words) for piece in seeds]
        parts = pretraining.share(f"skills{said}", try_skills, [(exam,) for exam in exams])
        attempts = [attempt for part in parts for attempt in part]
        figures += by_name(attempts, f"skill {{}}, lab{said}")
    return figures


def reading(low_level: Path) -> list[Figure]:
    """How phrases are read that hold words of the exam, which no reader was taught."""
    found = final(LowLevel.load(low_level).reader, QUESTIONS)
    kinds = found["kinds"]
    rates = {
        "phrase of known words read rightly": kinds[HEARD],
        "unheard phrase read rightly": found["unheard words"],
        **{f"unheard phrase read rightly, {kind}": kinds[kind] for kind in UNHEARD},
        "what can't be done refused": found["refusals"],
        **{f"everyday phrases {kind}": rate for kind, rate in found["everyday"].items()},
        **{f"confused, {pair}": rate for pair, rate in found["confused"].items()},
    }
    return [
        Figure(name=name, value=rate["success"], n=rate["n"], interval=tuple(rate["interval"]))
        for name, rate in rates.items()
    ]


def _tasks(pretraining: Pretraining, low_level: Path) -> list[Figure]:
    """Tasks with the oracle as the high level, at all sites."""
    figures = []
    for site in SITES:
        plan = Plan(
            high_level=ORACLE,
            low_level=str(low_level),
            site=site,
            seeds=(0, pretraining.scale.tasks),
        )
        rows = _rows(pretraining, f"oracle, {site}", plan)
        figures += _by_task(rows, f"oracle, {{}}, {site}")
    return figures


def _trials(pretraining: Pretraining, low_level: Path, high_level: Path) -> list[Figure]:
    """The two levels together, at all sites."""
    figures = []
    for site in SITES:
        plan = Plan(
            high_level=str(high_level),
            low_level=str(low_level),
            site=site,
            seeds=(0, pretraining.scale.trials),
        )
        rows = _rows(pretraining, f"base, {site}", plan)
        figures.append(figure(f"tasks, {site}", (row.success for row in rows)))
        figures += _by_task(rows, f"{{}}, {site}")
    return figures


def _by_task(rows: Sequence[Row], title: str) -> list[Figure]:
    return by_name([Tried(row.task, row.success, row.steps) for row in rows], title)


def _rows(pretraining: Pretraining, name: str, plan: Plan) -> list[Row]:
    cases = plan.cases()
    jobs = [(plan, tuple(cases[part::PARTS])) for part in range(min(PARTS, len(cases)))]
    return [row for rows in pretraining.share(name, roll_out, jobs) for row in rows]


def roll_out(plan: Plan, cases: Sequence[Case]) -> list[Row]:
    """Episode after episode in one process."""
    evaluator = Evaluator(plan)
    rows = [evaluator(case) for case in cases]
    evaluator.close()
    return rows


def _pieces(first: int, count: int) -> list[tuple[int, ...]]:
    seeds = range(first, first + count)
    return [tuple(seeds[part::PARTS]) for part in range(min(PARTS, count))]
