"""Rates and their intervals."""

import pytest

from services.learner.pretrain.exam import Attempt, by_name, figure, wilson


def test_a_rate_has_its_wilson_interval() -> None:
    assert wilson(5, 10) == pytest.approx((0.2366, 0.7634), abs=1e-4)
    assert wilson(10, 10) == pytest.approx((0.7225, 1.0), abs=1e-4)
    assert wilson(0, 0) == (0.0, 1.0)


def test_attempts_are_counted_by_name() -> None:
    tried = [Attempt("pick", True, 5), Attempt("bin", False, 120), Attempt("pick", False, 120)]
    figures = by_name(tried, "skill {}")
    assert [(found.name, found.value, found.n) for found in figures] == [
        ("skill bin", 0.0, 1),
        ("skill pick", 0.5, 2),
    ]
    assert figure("none", []).n == 0
