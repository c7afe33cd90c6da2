"""What an evaluation reports, from rows that were made up."""

import json

import pytest

from services.actor.evaluate import Plan, Row, episodes, read_rows, summarize
from shared.intervals import wilson
from shared.seeds import purpose


def rows(*outcomes):
    return [
        Row(2_000_000_000 + i, ("sandwich", "pack")[i % 2], "do it", done, 100, 5, "a" * 64)
        for i, done in enumerate(outcomes)
    ]


def test_a_summary_has_success_with_n_and_interval_over_all_and_by_task():
    summary = summarize(rows(True, False, True, False))
    assert summary["success"] == 0.5
    assert summary["n"] == 4
    low, high = summary["interval"]
    assert low < 0.5 < high
    assert summary["tasks"]["sandwich"]["success"] == 1.0
    assert summary["tasks"]["pack"]["success"] == 0.0


def test_every_high_level_is_evaluated_on_the_same_seeds_which_are_for_nothing_else():
    plan = Plan("base", ("sandwich", "pack"), "lab", 6)
    assert episodes(plan) == episodes(plan._replace(high_level="oracle"))
    assert {purpose(seed) for seed, _ in episodes(plan)} == {"evaluation"}


def test_a_half_written_last_row_is_done_again(tmp_path):
    file = tmp_path / "rows.jsonl"
    whole = rows(True, False)
    lines = [json.dumps(row._asdict()) for row in whole]
    file.write_text("\n".join(lines) + '\n{"seed": 20000')
    assert read_rows(file) == whole


@pytest.mark.parametrize(
    ("successes", "n", "interval"),
    # Brown, Cai, DasGupta 2001 and textbooks: 0 of 10, 5 of 10, 45 of 60.
    [(0, 10, (0.0, 0.2775)), (5, 10, (0.2366, 0.7634)), (45, 60, (0.6277, 0.8422))],
)
def test_the_interval_is_wilsons(successes, n, interval):
    assert wilson(successes, n) == pytest.approx(interval, abs=1e-3)
