"""So many within any hour, whatever the clock does."""

from shared.budget import HOUR_NS, Budget

MINUTE_NS = HOUR_NS // 60


def test_what_was_spent_is_free_again_an_hour_later_and_not_sooner():
    budget = Budget(2)
    assert [budget.spend(at * MINUTE_NS) for at in (0, 30, 59)] == [True, True, False]
    assert budget.spend(60 * MINUTE_NS)
    assert not budget.spend(89 * MINUTE_NS)
    assert budget.spend(90 * MINUTE_NS)


def test_no_limit_is_none():
    budget = Budget(0)
    assert all(budget.spend(0) for _ in range(1000))
    assert budget.spent_ns == ()


def test_a_restart_does_not_refill_it():
    before = Budget(2)
    before.spend(0)
    before.spend(MINUTE_NS)
    after = Budget(2, before.spent_ns)
    assert not after.spend(2 * MINUTE_NS)
    assert after.spend(60 * MINUTE_NS)


def test_a_clock_that_was_set_back_neither_refills_nor_blocks_it_for_long():
    budget = Budget(1, [48 * HOUR_NS])
    assert not budget.spend(0)
    assert not budget.spend(HOUR_NS - 1)
    assert budget.spend(HOUR_NS)
