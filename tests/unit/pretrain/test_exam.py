"""Rates and their intervals."""

from services.learner.pretrain.exam import Tried, by_name, figure
from services.learner.pretrain.figures import roll_out
from shared.evaluation.plan import Plan


def test_attempts_are_counted_by_name() -> None:
    tried = [Tried("pick", True, 5), Tried("bin", False, 120), Tried("pick", False, 120)]
    figures = by_name(tried, "skill {}")
    assert [(found.name, found.value, found.n) for found in figures] == [
        ("skill bin", 0.0, 1),
        ("skill pick", 0.5, 2),
    ]
    assert figure("none", []).n == 0


def test_the_cards_rates_come_from_evaluations() -> None:
    plan = Plan(high_level="oracle", site="lab", tasks=("pack",), seeds=(0, 1))
    rows = roll_out(plan, plan.cases())
    assert [(row.seed, row.task) for row in rows] == plan.cases()
    assert rows[0].steps > 0
