"""Rates and their intervals."""

from services.learner.pretrain.exam import Attempt, by_name, figure


def test_attempts_are_counted_by_name() -> None:
    tried = [Attempt("pick", True, 5), Attempt("bin", False, 120), Attempt("pick", False, 120)]
    figures = by_name(tried, "skill {}")
    assert [(found.name, found.value, found.n) for found in figures] == [
        ("skill bin", 0.0, 1),
        ("skill pick", 0.5, 2),
    ]
    assert figure("none", []).n == 0
