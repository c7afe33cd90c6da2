"""The last stage: both levels are examined, and their cards get the figures."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeVar

from services.learner.pretrain import cards
from services.learner.pretrain.exam import Attempt, Exam, by_name, figure, try_skills, try_tasks
from services.learner.pretrain.low_fit import phrases
from services.learner.pretrain.stages import EXAM_SEED, PARTS, Pretraining
from services.learner.pretrain.trial import Trial, run
from shared.policies import checkpoint
from shared.policies.checkpoint import Figure
from shared.seeds import EVALUATION
from shared.workcell.skills import COMMANDS

SITES = ("lab", "workshop")
J = TypeVar("J")
R = TypeVar("R")


def examine(pretraining: Pretraining, low_level: Path, high_level: Path) -> None:
    """Write `low_level` and `high_level` in the output folder, with figures on their cards."""
    skills = _skills(pretraining, low_level)
    _publish(low_level, pretraining.out / "low_level", [*skills, *_tasks(pretraining, low_level)])
    trials = _trials(pretraining, low_level, high_level)
    _publish(high_level, pretraining.out / "high_level", trials)


def _publish(source: Path, target: Path, figures: Sequence[Figure]) -> None:
    tensors, card = checkpoint.load(source)
    checkpoint.save(target, tensors, cards.examined(card, figures))


def _skills(pretraining: Pretraining, low_level: Path) -> list[Figure]:
    """Each skill in the lab, by the canonical commands and by paraphrases never trained on."""
    held_out = dict(zip(COMMANDS, map(tuple, phrases(held_out=True)), strict=True))
    figures = []
    for said, words in (("", {}), (", unheard paraphrases", held_out)):
        seeds = _pieces(EXAM_SEED, pretraining.scale.chains)
        exams = [Exam(low_level, "lab", piece, words) for piece in seeds]
        attempts = _all(pretraining, f"skills{said}", try_skills, exams)
        figures += by_name(attempts, f"skill {{}}, lab{said}")
    return figures


def _tasks(pretraining: Pretraining, low_level: Path) -> list[Figure]:
    """Tasks with the oracle as the high level, at both sites."""
    figures = []
    for site in SITES:
        seeds = _pieces(EVALUATION.start, pretraining.scale.tasks)
        exams = [Exam(low_level, site, piece, {}) for piece in seeds]
        attempts = _all(pretraining, f"oracle, {site}", try_tasks, exams)
        figures += by_name(attempts, f"oracle, {{}}, {site}")
    return figures


def _trials(pretraining: Pretraining, low_level: Path, high_level: Path) -> list[Figure]:
    """The two levels together, at both sites."""
    figures = []
    for site in SITES:
        seeds = _pieces(EVALUATION.start, pretraining.scale.trials)
        trials = [Trial(high_level, low_level, site, piece) for piece in seeds]
        done = _all(pretraining, f"base, {site}", _attempts, trials)
        figures.append(figure(f"tasks, {site}", (attempt.success for attempt in done)))
        figures += by_name(done, f"{{}}, {site}")
    return figures


def _attempts(trial: Trial) -> list[Attempt]:
    return run(trial).attempts


def _all(
    pretraining: Pretraining,
    name: str,
    work: Callable[[J], list[Attempt]],
    jobs: Sequence[J],
) -> list[Attempt]:
    parts = pretraining.share(name, work, [(job,) for job in jobs])
    return [attempt for part in parts for attempt in part]


def _pieces(first: int, count: int) -> list[tuple[int, ...]]:
    seeds = range(first, first + count)
    return [tuple(seeds[part::PARTS]) for part in range(min(PARTS, count))]
