"""Intervals and paired tests, held against figures of textbooks and against each other."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from shared.intervals import flipped, mcnemar, paired_difference, rate, seeds_difference, wilson

OUTCOMES = st.lists(st.tuples(st.booleans(), st.booleans()), min_size=1, max_size=60)


@pytest.mark.parametrize(
    ("successes", "n", "interval"),
    # Brown, Cai, DasGupta 2001 and textbooks: 0 of 10, 5 of 10, 45 of 60.
    [(0, 10, (0.0, 0.2775)), (5, 10, (0.2366, 0.7634)), (45, 60, (0.6277, 0.8422))],
)
def test_the_interval_is_wilsons(successes, n, interval):
    assert wilson(successes, n) == pytest.approx(interval, abs=1e-3)


def test_a_rate_of_nothing_says_that_nothing_is_known():
    assert rate([]) == {"success": 0.0, "n": 0, "interval": [0.0, 1.0]}
    assert rate([True, False])["success"] == 0.5


@pytest.mark.parametrize(
    ("only_first", "only_second", "p"),
    # The two-sided sign test of b of b + c: 2 * sum(C(n, k)) / 2^n.
    [(0, 5, 0.0625), (1, 9, 0.021484), (4, 4, 1.0), (0, 0, 1.0)],
)
def test_mcnemar_is_exact_over_the_pairs_that_differ(only_first, only_second, p):
    pairs = [(True, False)] * only_first + [(False, True)] * only_second + [(True, True)] * 7
    first, second = zip(*pairs, strict=True)
    assert mcnemar(first, second) == pytest.approx(p, abs=1e-6)


@given(st.lists(st.integers(-6, 6), max_size=8))
def test_flipped_is_exact_over_all_signs(gaps):
    sums = [sum(signed) for signed in itertools.product(*((-gap, gap) for gap in gaps))]
    expected = sum(one <= sum(gaps) for one in sums) / len(sums)
    assert flipped(gaps) == pytest.approx(expected)


@given(OUTCOMES)
def test_mcnemar_doesnt_care_which_comes_first(pairs):
    first, second = zip(*pairs, strict=True)
    assert mcnemar(first, second) == mcnemar(second, first)


def test_a_difference_lies_in_its_interval_and_turns_with_its_sides():
    chance = np.random.default_rng(1)
    first, second = chance.random(50) < 0.8, chance.random(50) < 0.5
    gap = paired_difference(first, second)
    back = paired_difference(second, first)
    assert gap.low < gap.value < gap.high
    assert back == pytest.approx((-gap.value, -gap.high, -gap.low))


@pytest.mark.parametrize(
    ("both", "first", "second", "neither", "interval"),
    # Newcombe 1998, table of method 10.
    [(36, 12, 2, 0, (0.0569, 0.3404)), (54, 0, 0, 0, (-0.0664, 0.0664))],
)
def test_the_interval_of_a_difference_is_newcombes(both, first, second, neither, interval):
    pairs = [(1, 1)] * both + [(1, 0)] * first + [(0, 1)] * second + [(0, 0)] * neither
    gap = paired_difference(*zip(*pairs, strict=True))
    assert (gap.low, gap.high) == pytest.approx(interval, abs=1e-4)


def test_training_seeds_that_all_agree_leave_the_chance_of_the_scenes():
    always = [[True] * 40] * 3
    gap = seeds_difference(always, always, draws=500)
    assert gap == paired_difference(always[0], always[0])
    assert gap.low < 0 < gap.high


def test_pairs_that_vary_together_give_a_narrower_interval_than_those_that_dont():
    hard = np.random.default_rng(2).random(80) < 0.5
    together = paired_difference(hard, hard & (np.arange(80) % 10 > 0))
    apart = paired_difference(hard, np.roll(hard, 1))
    assert together.high - together.low < apart.high - apart.low


def test_training_seeds_that_disagree_widen_the_interval():
    zeros = [[0.0] * 30] * 3
    agree = [[1.0, 0.0] * 15] * 3
    disagree = [[1.0] * 30, [0.0] * 30, [1.0, 0.0] * 15]
    narrow = seeds_difference(agree, zeros, draws=500)
    wide = seeds_difference(disagree, zeros, draws=500)
    assert narrow.value == wide.value == 0.5
    assert wide.high - wide.low > 2 * (narrow.high - narrow.low)


@pytest.mark.parametrize(("first", "second"), [([1, 0], [1]), ([], [])])
def test_what_is_no_pair_is_an_error(first, second):
    with pytest.raises(ValueError, match=r"pairs|same"):
        paired_difference(first, second)
