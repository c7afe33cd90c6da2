"""What `hld experiment dagger` tells of the outcomes that are kept in the repository."""

import json
import shutil
from pathlib import Path

import pytest

from services.learner import experiments
from services.learner.experiments import dagger
from services.learner.experiments.bench import Bench, Scale
from services.learner.experiments.dagger import compare
from services.learner.experiments.dagger.kept import Archive
from services.learner.experiments.dagger.notes import Notes
from services.learner.experiments.dagger.report import findings
from services.learner.experiments.dagger.run import Tried
from services.learner.experiments.dagger.scale import CORE, MAIN, DaggerSettings
from services.learner.experiments.findings import Findings
from services.learner.experiments.report import write
from shared.errors import HldError
from tests.unit.experiments.bench import Here, untold

KEPT = Path(experiments.__file__).parent / "measured" / "outcomes"
FILES = sorted(KEPT.rglob("*.json.gz"))
assert FILES
ABOUT = {"command": "c", "date": "d", "site": "far", "low_level_sha256": "a",
         "high_level": None, "high_level_sha256": None}  # fmt: skip


def bench(out: Path, site: str = "far") -> Bench:
    return Bench(out, Here(), untold, (0, 200), scale=Scale.CORE, site=site)


@pytest.mark.parametrize("file", FILES, ids=lambda file: f"{file.parent.name}-{file.stem}")
def test_what_is_kept_belongs_to_the_settings_and_policies_of_today(file: Path) -> None:
    notes = Notes(bench(KEPT.parent, file.parent.name), CORE)
    name = file.name.removesuffix(".json.gz")
    arm = name.rpartition("-")[0]
    note = (
        notes.untrained()
        if name == "untrained" or arm == "flat"
        else notes.rounds(MAIN)
        if arm == MAIN
        else notes.arm(arm)
    )
    assert Archive(file.parent).has(name, note)


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> Findings:
    """What comes of the first training seed at far, without arms."""
    out = tmp_path_factory.mktemp("dagger")
    shutil.copytree(KEPT, out / "outcomes")
    here = bench(out)
    told = compare(here, CORE.model_copy(update={"seeds": 1, "arms": ()}))
    assert isinstance(here.pool, Here)
    assert here.pool.jobs == 0
    return told


def test_the_report_that_is_written_begins_with_what_machines_look_for(
    found: Findings, tmp_path: Path
) -> None:
    write(tmp_path, found, ABOUT)
    report = json.loads((tmp_path / "report.json").read_text())
    base = report["arms"]["base"]
    assert (base["n"], len(base["seeds"])) == (200, 1)
    low, high = base["interval"]
    assert 0 <= low <= base["success"] <= high <= 1
    assert 0 < report["gap_closed"]["value"] <= 1
    assert report["corrections_share"]["value"] > 0
    assert report["retention"]["lab"]["n"] == 200
    assert report["arms"] == report["figures"]["arms"]
    reached = {one["what"]: one["reached"] for one in report["figures"]["targets"]}
    assert set(reached.values()) <= {True, False}
    assert "gap between base and oracle closed after 3 rounds" in reached
    assert (tmp_path / "dagger.svg").exists()
    assert "| base |" in (tmp_path / "report.md").read_text()


def test_what_was_never_corrected_is_compared_in_pairs(found: Findings) -> None:
    unseen = found.figures["retention"]["unseen"]
    assert unseen["less"]["n"] == unseen["after"]["n"] == unseen["before"]["n"] > 0
    difference = unseen["after"]["success"] - unseen["before"]["success"]
    assert unseen["less"]["difference"] == pytest.approx(difference, abs=2e-4)


def test_where_the_oracle_is_no_better_there_is_no_gap_and_no_target(tmp_path: Path) -> None:
    shutil.copytree(KEPT, tmp_path / "outcomes")
    kept = Archive(tmp_path / "outcomes" / "far")
    notes = Notes(bench(tmp_path), CORE)
    untrained = kept.get("untrained", notes.untrained(), pytest.fail)
    course = kept.get(f"{MAIN}-0", notes.rounds(MAIN), pytest.fail)
    rows = {name: [some] for name, some in (untrained.rows | course.rows).items()}
    alike = Tried(
        rows={**rows, "base": rows["oracle"]},
        lab={"base": [untrained.lab["base"]], "last": [course.lab["last"]]},
        paces=course.paces,
        prompts=[frozenset(row.prompt for row in untrained.rows["base"])],
        taught=[],
    )
    told = findings(CORE.model_copy(update={"seeds": 1, "arms": ()}), alike, "lab")
    assert told.figures["gap_closed"]["value"] is None
    assert told.figures["targets"][0]["reached"] is None
    assert "by its interval" in told.tables[0].rows[0][2]
    assert told.figures["retention"]["unseen"]["less"] is None
    notes_of = " ".join(told.notes)
    assert "no retention" in notes_of
    assert "flat arm was not at hand" in notes_of
    write(tmp_path, told, ABOUT)


def test_the_oracle_has_nothing_to_learn(tmp_path: Path) -> None:
    with pytest.raises(HldError, match="--high-level names a version"):
        compare(Bench(tmp_path, Here(), untold, (0, 1), high_level="oracle"), CORE)


@pytest.mark.parametrize(("site", "arms"), [("lab", ["lab"]), ("near", ["lab", "site"])])
def test_in_the_lab_nothing_is_demonstrated_twice(
    site: str, arms: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[DaggerSettings] = []
    monkeypatch.setattr(dagger, "_found", lambda _, settings: seen.append(settings))
    compare(bench(tmp_path, site), CORE.model_copy(update={"seeds": 1}))
    assert [name for name in seen[0].arms if name in ("lab", "site")] == arms
