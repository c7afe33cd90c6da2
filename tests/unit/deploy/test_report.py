"""The report, from boards and evaluations that were made up."""

import json

import pytest

from deploy.board import Tally
from deploy.report import Report
from shared.errors import HldError


class Seen:
    """What a report asks of a board."""

    def __init__(self, versions, tallies, **learner):
        self._versions, self._tallies, self.learner = versions, tallies, learner

    def versions(self):
        return [(name, None) for name in self._versions]

    def tally(self):
        return self._tallies


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
                "low_level_sha256": "a" * 64,
            }
            for name, success in found.items()
        }


def report_of(folder, board, judged, rounds=2):
    return Report(folder / "out" / "report.json", ("pack",), "lab", board, judged, rounds)


TALLIES = {"1.0": Tally(4, 1, 11), "1.1": Tally(4, 2, 7), "2.1": Tally(1, 1, 1)}


def test_a_version_has_what_it_learned_from_also_across_a_learners_restart(tmp_path):
    board = Seen(["1.0", "1.1", "2.2"], TALLIES)
    rows = report_of(tmp_path, board, Judged()).content()["versions"]
    assert [row["episodes"] for row in rows] == [0, 4, 9]
    assert [row["corrections"] for row in rows] == [0, 11, 19]


def test_it_is_complete_only_when_every_version_and_the_oracle_are_evaluated(tmp_path):
    board = Seen(["1.0", "1.1"], TALLIES, state="collecting", round=1)
    judged = Judged(oracle=0.9, **{"1.0": 0.2})
    report = report_of(tmp_path, board, judged, rounds=1)
    assert not report.complete()
    judged.found |= Judged(**{"1.1": 0.5}).found
    assert report.complete()


def test_a_learner_that_stopped_ends_the_run_with_its_reason(tmp_path):
    board = Seen(["1.0"], {}, state="stopped", round=1, reason="the low level changed")
    with pytest.raises(HldError, match="the low level changed"):
        report_of(tmp_path, board, Judged()).complete()


def test_the_file_has_the_schema_that_others_read_and_a_plot_beside_it(tmp_path):
    board = Seen(["1.0", "1.1"], TALLIES)
    report = report_of(tmp_path, board, Judged(oracle=0.9, **{"1.0": 0.2, "1.1": 0.5}))
    report.write()
    written = json.loads(report.path.read_text())
    assert written["schema"] == 1
    assert written["low_level_sha256"] == {"before": "a" * 64, "after": "a" * 64}
    assert written["oracle"]["success"] == 0.9
    assert [row["success"] for row in written["versions"]] == [0.2, 0.5]
    assert report.plot().read_text().lstrip().startswith("<?xml")
