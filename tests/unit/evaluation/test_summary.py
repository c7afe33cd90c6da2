"""What a report says, from rows that were made up."""

import json
from datetime import UTC, date, datetime

from shared.evaluation.plan import Plan
from shared.evaluation.summary import report, summarize
from tests.unit.evaluation.rows import SHA, attempt, row

ROWS = [
    row(1, True, "sandwich", attempts=(attempt(), attempt("put it down", "put down", False))),
    row(2, False, "pack", "wrong object", attempts=(attempt(steps=60), attempt("wait", ""))),
    row(3, True, "sandwich", steps=300),
    row(4, False, "pack", "pick up failed", attempts=(attempt(success=False),)),
]


def test_success_has_n_and_an_interval_over_all_and_by_task():
    summary = summarize(ROWS)
    assert (summary["success"], summary["n"]) == (0.5, 4)
    low, high = summary["interval"]
    assert low < 0.5 < high
    assert {task: (one["success"], one["n"]) for task, one in summary["tasks"].items()} == {
        "sandwich": (1.0, 2),
        "pack": (0.0, 2),
    }


def test_skills_are_counted_by_attempt_and_waits_are_none():
    skills = summarize(ROWS)["skills"]
    assert list(skills) == ["pick up", "put down"]
    assert (skills["pick up"]["success"], skills["pick up"]["n"]) == (0.6667, 3)
    assert skills["pick up"]["steps"] == 50.0
    assert (skills["put down"]["success"], skills["put down"]["steps"]) == (0.0, None)


def test_failures_say_what_went_wrong_first_and_sum_to_the_episodes_that_failed():
    summary = summarize(ROWS)
    assert summary["failures"] == {"wrong object": 1, "pick up failed": 1}
    assert summary["tasks"]["sandwich"]["failures"] == {}


def test_steps_and_decisions_are_means_and_the_low_level_is_named():
    summary = summarize(ROWS)
    assert (summary["steps"], summary["decisions"]) == (150.0, 5.0)
    assert summary["progress"] == 0.75
    assert summary["asked"] == {"interval": 16, "start": 4}
    assert summary["low_level_sha256"] == [SHA]


def test_a_report_doesnt_hang_on_the_order_in_which_processes_finish():
    plan = Plan(seeds=(0, 4))
    one = report(plan, ROWS, "base", "hld evaluate")
    other = report(plan, ROWS[::-1], "base", "hld evaluate")
    assert json.dumps({**one, "date": ""}) == json.dumps({**other, "date": ""})


def test_a_report_says_what_was_evaluated_where_and_when():
    before = datetime.now(UTC).date()
    one = report(Plan(seeds=(0, 4)), ROWS, "base", "hld evaluate --seeds 0:4")
    assert (one["seeds"], one["site"], one["high_level"]) == ("0:4", "far", "base")
    assert one["command"] == "hld evaluate --seeds 0:4"
    assert before <= date.fromisoformat(one["date"]) <= datetime.now(UTC).date()


def test_a_call_is_flawless_only_if_both_levels_did_their_part():
    assert attempt().flawless
    assert not attempt(success=False).flawless
    assert not attempt(wrong=1).flawless
