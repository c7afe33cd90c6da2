"""The report, from boards and evaluations that were made up."""

import json

import pytest

from deploy.board import Made
from deploy.report import Report
from shared.errors import HldError


class Seen:
    """What a report asks of a board."""

    def __init__(self, *versions, low_level=(), **learner):
        self._versions, self._low_level, self.learner = versions, dict(low_level), learner

    def versions(self):
        return list(self._versions)

    def low_level(self, number):
        return set(self._low_level.get(number, ()))


class Judged:
    """What a report asks of the evaluations."""

    episodes = 10

    def __init__(self, **found):
        self.found = {
            name.replace("_", "."): {
                "success": success,
                "n": 10,
                "interval": [success / 2, min(1.0, success * 1.5)],
                "tasks": {},
                "low_level_sha256": ["a" * 64],
            }
            for name, success in found.items()
        }


def report_of(folder, board, judged, rounds=2):
    return Report(folder / "out" / "report.json", ("pack",), "lab", board, judged, rounds)


BASE = Made("1.0", None)
FIRST = Made("1.1", None, 4, 11, 80, 9)
SECOND = Made("2.2", None, 5, 8, 150, 20)


def test_a_version_has_what_all_rounds_up_to_it_were_made_from(tmp_path):
    rows = report_of(tmp_path, Seen(BASE, FIRST, SECOND), Judged()).content()["versions"]
    assert [row["episodes"] for row in rows] == [0, 4, 9]
    assert [row["corrections"] for row in rows] == [0, 11, 19]
    assert [row["held_out"] for row in rows] == [0, 9, 20]


def test_a_low_level_that_changed_during_the_run_shows_in_the_report(tmp_path):
    board = Seen(BASE, FIRST, low_level={"0": ["a" * 64], "1": ["b" * 64]})
    told = report_of(tmp_path, board, Judged()).content()["low_level_sha256"]
    assert told == {"before": "a" * 64, "after": "b" * 64}
    judged = Judged(**{"1.1": 0.5})
    told = report_of(tmp_path, board, judged).content()["low_level_sha256"]
    assert told["after"] == f"{'a' * 64}, {'b' * 64}"


def test_it_is_complete_only_when_every_version_and_the_oracle_are_evaluated(tmp_path):
    board = Seen(BASE, FIRST, state="collecting", round=1)
    judged = Judged(oracle=0.9, **{"1.0": 0.2})
    report = report_of(tmp_path, board, judged, rounds=1)
    assert not report.complete()
    judged.found |= Judged(**{"1.1": 0.5}).found
    assert report.complete()


def test_a_learner_that_stopped_ends_the_run_with_its_reason(tmp_path):
    board = Seen(BASE, state="stopped", round=1, reason="the low level changed")
    with pytest.raises(HldError, match="the low level changed"):
        report_of(tmp_path, board, Judged()).complete()


def test_the_file_has_the_schema_that_others_read_and_a_plot_beside_it(tmp_path):
    board = Seen(BASE, FIRST)
    report = report_of(tmp_path, board, Judged(oracle=0.9, **{"1.0": 0.2, "1.1": 0.5}))
    report.write()
    written = json.loads(report.path.read_text())
    assert written["schema"] == 1
    assert written["low_level_sha256"] == {"before": "a" * 64, "after": "a" * 64}
    assert written["oracle"]["success"] == 0.9
    assert [row["success"] for row in written["versions"]] == [0.2, 0.5]
    assert report.plot().read_text().lstrip().startswith("<?xml")
