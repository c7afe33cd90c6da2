"""What an evaluation says: rates with n and intervals, over all, by task and by skill."""

from collections import Counter
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime
from typing import Any

from shared.evaluation.attempts import SKILL_NAMES, Attempt, Row
from shared.evaluation.plan import ORACLE, Plan
from shared.intervals import rate
from shared.policies.checkpoint import load_card

SCHEMA = 2


def report(plan: Plan, rows: Iterable[Row], high_level: str, command: str) -> dict[str, Any]:
    """The content of report.json. high_level: as it was asked for. command: what makes it again."""
    first, end = plan.seeds
    return {
        "schema": SCHEMA,
        "high_level": high_level,
        "high_level_sha256": None
        if plan.high_level == ORACLE
        else load_card(plan.high_level_folder()).tensors_sha256,
        "site": plan.site,
        "length": plan.skills,
        "seeds": f"{first}:{end}",
        "command": command,
        "date": datetime.now(UTC).date().isoformat(),
        **summarize(rows),
    }


def summarize(rows: Iterable[Row]) -> dict[str, Any]:
    """Success by task and by skill, what went wrong first, and what it took.

    progress, steps, decisions, wrong_decisions: means over the episodes, a decision being a query
    of π_HL; see `Row`.
    failures: of the episodes that failed, how many by what went wrong first. diverged: steps of
    physics that were taken back.
    """
    rows = sorted(rows, key=lambda row: (row.seed, row.task))
    by_task = {task: [row for row in rows if row.task == task] for task in _tasks(rows)}
    return {
        **_figures(rows),
        "tasks": {task: _figures(some) for task, some in by_task.items()},
        "skills": skill_rates(attempt for row in rows for attempt in row.attempts),
        "asked": dict(sum((Counter(row.asked) for row in rows), Counter[str]()).most_common()),
        "diverged": sum(row.diverged for row in rows),
        "low_level_sha256": sorted({row.low_level_sha256 for row in rows}),
    }


def skill_rates(attempts: Iterable[Attempt]) -> dict[str, Any]:
    """Success by skill over all attempts, in the order of the skills; those never tried are not in.

    steps: mean over the attempts that were achieved; None if none was.
    """
    attempts = list(attempts)
    rates = {}
    for name in SKILL_NAMES.values():
        tried = [attempt for attempt in attempts if attempt.skill == name]
        if tried:
            steps = [attempt.steps for attempt in tried if attempt.success]
            took = _mean(steps) if steps else None
            rates[name] = {**rate([one.success for one in tried]), "steps": took}
    return rates


def _tasks(rows: Iterable[Row]) -> list[str]:
    return sorted({row.task for row in rows})


def _figures(rows: Sequence[Row]) -> dict[str, Any]:
    failures = Counter(row.failure for row in rows if not row.success)
    return {
        **rate([row.success for row in rows]),
        "progress": round(sum(row.progress for row in rows) / max(1, len(rows)), 4),
        "steps": _mean([row.steps for row in rows]),
        "decisions": _mean([row.decisions for row in rows]),
        "wrong_decisions": _mean([row.wrong for row in rows]),
        "failures": dict(failures.most_common()),
    }


def _mean(numbers: Sequence[int]) -> float:
    return round(sum(numbers) / max(1, len(numbers)), 1)
