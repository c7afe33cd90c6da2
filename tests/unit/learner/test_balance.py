"""Weights of labels: by correction, and with a cap for each phrase."""

from collections import defaultdict

import pytest
from hypothesis import given
from hypothesis import strategies as st

from services.learner.labels.aggregate import Ground, Label
from services.learner.labels.balance import BalanceSettings, balance


def label(number: int, text: str, correction: str, weight: float = 1.0) -> Label:
    return Label(f"e-{number}", "e", text, weight, Ground.HELD, correction)


SAID = [
    *(label(n, "ham", "long") for n in range(6)),
    label(6, "ham", "short"),
    label(7, "toast", "other", 0.5),
    label(8, "toast", "other", 1.5),
]


def shares(labels: tuple[Label, ...]) -> dict[str, float]:
    found = defaultdict[str, float](float)
    for one in labels:
        found[one.text] += one.weight
    total = sum(found.values())
    return {text: share / total for text, share in found.items()}


def test_by_default_nothing_changes() -> None:
    assert balance(SAID, BalanceSettings()) == tuple(SAID)
    assert balance([], BalanceSettings(by="correction", phrase_cap=0.1)) == ()


def test_by_correction_a_long_one_counts_as_much_as_a_short_one() -> None:
    found = balance(SAID, BalanceSettings(by="correction"))
    sums = defaultdict[str, float](float)
    for one in found:
        sums[one.correction] += one.weight
    assert sums == pytest.approx({"long": 3.0, "short": 3.0, "other": 3.0})
    assert found[8].weight == pytest.approx(3 * found[7].weight)


def test_no_phrase_has_more_than_its_share() -> None:
    found = balance([*SAID, label(9, "wait", "w")], BalanceSettings(phrase_cap=0.5))
    assert shares(found) == pytest.approx({"ham": 0.5, "toast": 1 / 3, "wait": 1 / 6})
    assert shares(balance(SAID, BalanceSettings(phrase_cap=0.1))) == pytest.approx(
        {"ham": 0.5, "toast": 0.5}
    )


LABELS = st.lists(
    st.builds(
        label,
        st.integers(0, 99),
        st.sampled_from(["ham", "toast", "wait", "cheese"]),
        st.sampled_from(["a", "b", "c"]),
        st.floats(0.01, 10),
    ),
    min_size=1,
    max_size=30,
)


@given(LABELS, st.floats(0.01, 1), st.sampled_from(["decision", "correction"]))
def test_the_cap_holds_and_the_sum_stays(said: list[Label], cap: float, by: str) -> None:
    found = balance(said, BalanceSettings.model_validate({"by": by, "phrase_cap": cap}))
    assert sum(one.weight for one in found) == pytest.approx(sum(one.weight for one in said))
    allowed = max(cap, 1 / len({one.text for one in said}))
    assert max(shares(found).values()) <= allowed + 1e-6
    assert [one.decision for one in found] == [one.decision for one in said]
    assert all(one.weight > 0 for one in found)
