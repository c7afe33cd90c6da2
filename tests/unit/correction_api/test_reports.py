"""Measured reports: what was measured here comes first, and what is broken counts as not there."""

import json
from pathlib import Path

import pytest

from services.correction_api.problems import Problem
from services.correction_api.reports import Reports

EVALUATED = {"success": 0.71, "n": 200, "interval": [0.64, 0.77]}


def test_what_comes_with_the_service_has_the_shape_of_the_experiment() -> None:
    figures = Reports(None, None).experiment("transitions")["figures"]
    for paces in figures.values():
        for ways in paces.values():
            for cell in ways.values():
                assert cell["interval"][0] <= cell["success"] <= cell["interval"][1]
                assert cell["n"] == 120


def test_what_was_not_measured_says_how_to_measure_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("services.correction_api.reports.SHIPPED", tmp_path / "shipped")
    reports = Reports(tmp_path, None)
    assert "hld experiment horizon" in reports.listed()["horizon"]
    with pytest.raises(Problem, match="not measured yet: run hld experiment horizon"):
        reports.experiment("horizon")
    (tmp_path / "horizon").mkdir()
    (tmp_path / "horizon" / "report.json").write_text('{"figures": {"sandwich"')
    assert reports.listed()["horizon"]
    (tmp_path / "horizon" / "report.json").write_text('{"figures": {"sandwich": {}}}')
    assert reports.experiment("horizon") == {"figures": {"sandwich": {}}}
    assert reports.listed()["horizon"] == ""
    with pytest.raises(Problem, match="nearest known: 'horizon'"):
        reports.experiment("horizn")


def test_evaluations_are_read_by_version_and_others_left_alone(tmp_path: Path) -> None:
    for name in ("1.0", "1.10", "oracle"):
        (tmp_path / f"{name}.json").write_text(json.dumps(EVALUATED))
    (tmp_path / "1.1.json").write_text("half of")
    (tmp_path / "1.2.json").write_text('{"schema": 2}')
    found = Reports(None, tmp_path).evaluations()
    assert {name: one.n for name, one in found.items()} == {"1.0": 200, "1.10": 200}
    assert Reports(None, tmp_path / "nowhere").evaluations() == {}
