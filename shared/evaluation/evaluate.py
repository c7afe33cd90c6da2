"""Evaluate: how often a hierarchy succeeds on scenes that no correction ever came from."""

from collections.abc import Callable, Iterator
from pathlib import Path

from shared.evaluation.attempts import Row
from shared.evaluation.episode import Evaluator
from shared.evaluation.plan import Case, Plan
from shared.evaluation.pool import Pool
from shared.evaluation.rows import Rows, measure


def evaluate(
    plan: Plan,
    pool: Pool,
    file: Path | None = None,
    make: Callable[[Plan], Evaluator] = Evaluator,
) -> Iterator[Row]:
    """A row for each case as they come. file: where they are kept, and need not be done again.

    make: of a plan what evaluates it in each process, where its policies are of another kind.
    """
    rows = Rows(file, Row, plan.note()) if file else None
    return measure(pool, make, plan, plan.cases(), _case, rows)


def _case(row: Row) -> Case:
    return Case(row.seed, row.task)
