"""Report and plots, from findings that were made up."""

import json

from services.learner.experiments import report
from services.learner.experiments.findings import Findings, Panel, Plot, Table, cell, curve
from shared.intervals import rate

ABOUT = {
    "command": "hld experiment x --out y",
    "date": "2026-11-26",
    "site": "lab",
    "low_level_sha256": "f" * 64,
    "high_level": "base",
    "high_level_sha256": "e" * 64,
}


def findings():
    some = {2.0: rate([True, False]), 4.0: rate([False, False])}
    dashed = curve("(1-ε)^T", some).model_copy(update={"dashed": True})
    numbers = Panel(title="pack", curves=(curve("base", some), dashed))
    names = Panel(title="skills", curves=(curve("π_LL", {"a": rate([True]), "b": rate([])}),))
    return Findings(
        title="A title",
        method=("Done so.",),
        figures={"pack": some[2.0]},
        tables=(Table(title="Rates", columns=("T", "success"), rows=(("2", cell(some[2.0])),)),),
        plots=(Plot(name="curves", title="Curves", x_label="T", panels=(numbers, names)),),
        notes=("Little.",),
    )


def test_the_report_is_the_same_for_machines_and_for_people_with_a_picture(tmp_path):
    report.write(tmp_path, findings(), ABOUT)
    content = json.loads((tmp_path / "report.json").read_text())
    assert content["figures"]["pack"] == {"success": 0.5, "n": 2, "interval": [0.0945, 0.9055]}
    assert (content["schema"], content["pictures"]) == (1, ["curves.svg"])
    page = (tmp_path / "report.md").read_text()
    assert "| 2 | 0.50 (0.09 to 0.91) |" in page
    assert "`hld experiment x --out y`, 2026-11-26, at lab; " in page
    assert f"π_LL `{'f' * 12}`, π_HL base `{'e' * 12}`." in page
    assert "![Curves](curves.svg)" in page
    assert "<svg" in (tmp_path / "curves.svg").read_text()


def test_a_report_without_given_policies_names_none(tmp_path):
    report.write(
        tmp_path, findings(), {**ABOUT, "low_level_sha256": None, "high_level_sha256": None}
    )
    page = (tmp_path / "report.md").read_text()
    assert "`hld experiment x --out y`, 2026-11-26, at lab.\n" in page


def test_equal_findings_make_equal_files(tmp_path):
    for name in ("one", "other"):
        (tmp_path / name).mkdir()
        report.write(tmp_path / name, findings(), ABOUT)
    pictures = [(tmp_path / name / "curves.svg").read_bytes() for name in ("one", "other")]
    assert pictures[0] == pictures[1]
