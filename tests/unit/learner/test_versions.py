"""`hld policy`: what it tells of a store, and what it says where there is none."""

import json
import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

from services.learner.store.sql import SqlStore, sqlite_url
from services.learner.store.store import Manifest, Marks, PolicyRecord, Round, RoundState
from services.learner.versions import app
from tests.unit.learner.test_gate import candidate
from tests.unit.learner.test_learner_store import REF

UNJUDGED = "held out 3 labels, needs 20: not judged"
RUN = CliRunner(env={"COLUMNS": "80"})


def record(number: int) -> PolicyRecord:
    return PolicyRecord(
        number=number,
        epoch=1,
        tensors=(REF,),
        bank=("wait",),
        settings={"width": 8},
        low_level_sha256="a" * 64,
        marks=Marks(),
        created_ns=1_795_000_000_000_000_000,
    )


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run with a base and three rounds: passed, refused, and let out unjudged."""
    folder = tmp_path_factory.mktemp("run")
    store = SqlStore(sqlite_url(folder / "learner.db"))
    store.take_over("learner", 1)
    store.found(record(0))
    for number, made in ((1, record(1)), (2, None), (3, record(2))):
        manifest = Manifest(episodes=12, corrections=80, settings={"train": {"steps": 4}})
        begun = Round(number=number, epoch=1, parent=0, seed=7, manifest=manifest, begun_ns=2)
        store.begin(begun)
        figures = {"labels": 90, "before": 0.5, "after": 0.75, "retained_before": 0.9}
        if number == 3:
            figures["unjudged"] = UNJUDGED
        ended = begun.model_copy(
            update={
                "state": RoundState.PASSED if made else RoundState.REFUSED,
                "reason": "" if made else "it agrees with 0.100 of 40 held-out labels",
                "figures": figures,
                "candidate": candidate().model_dump(mode="json"),
                "ended_ns": 3,
                "made": made.number if made else None,
            }
        )
        store.end(ended, made)
    store.close()
    return folder


def test_the_list_has_every_version_and_round_and_why_one_was_refused(
    data: Path, tmp_path: Path
) -> None:
    report = tmp_path / "deep" / "list.json"
    result = RUN.invoke(app, ["list", "--data", str(data), "--report", str(report)])
    assert result.exit_code == 0, result.output
    told = ("1.0", "1.1", "1.2", "in force", "0.50 → 0.75", "round 2: it agrees with 0.100")
    for text in (*told, f"round 3: {UNJUDGED}"):
        assert text in result.output
    told = json.loads(report.read_text())
    assert [one["in_force"] for one in told["versions"]] == [False, False, True]
    assert [one["round"] for one in told["versions"]] == [None, 1, 3]
    assert [one["state"] for one in told["rounds"]] == ["passed", "refused", "passed"]


def test_a_version_shows_what_made_it(data: Path) -> None:
    result = RUN.invoke(app, ["show", "1", "--data", str(data)])
    told = json.loads(result.output)
    assert (told["round"]["seed"], told["round"]["manifest"]["corrections"]) == (7, 80)
    assert told["tensors"][0]["sha256"] == REF.sha256
    unjudged = json.loads(RUN.invoke(app, ["show", "2", "--data", str(data)]).output)
    assert unjudged["round"]["figures"]["unjudged"] == UNJUDGED
    assert json.loads(RUN.invoke(app, ["show", "0", "--data", str(data)]).output)["round"] is None


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        (["show", "5", "--data", "{data}"], "no version 5 in {data}; there are 0 to 2"),
        (["list", "--data", "{data}/nowhere"], "no store of a learner: looked at {data}/nowhere/l"),
    ],
)
def test_what_is_not_there_is_told_with_what_is(
    data: Path, arguments: list[str], why: str, capfd: pytest.CaptureFixture[str]
) -> None:
    result = RUN.invoke(app, [one.format(data=data) for one in arguments])
    assert result.exit_code == 2
    assert why.format(data=data) in result.output + capfd.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "known"),
    [
        (["rollback", "7"], "no version 7; there are 0, 1, 2"),
        (["promote", "5"], "no round 5; there are 1, 2, 3"),
        (["promote", "1"], "round 1 passed the gate; its version is 1: roll back to it"),
    ],
)
def test_what_no_learner_could_do_is_refused_at_once_and_not_kept(
    data: Path, arguments: list[str], known: str, capfd: pytest.CaptureFixture[str]
) -> None:
    result = RUN.invoke(app, [*arguments, "--reason", "x", "--data", str(data)])
    assert result.exit_code == 2
    assert known in result.output + capfd.readouterr().err
    store = SqlStore(sqlite_url(data / "learner.db"))
    assert store.answers() == ()
    store.close()


def test_what_is_decided_is_kept_for_the_next_learner_and_listed(
    data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("services.learner.versions.ANSWER_S", 0.0)
    copied = tmp_path / "run"
    shutil.copytree(data, copied)
    result = RUN.invoke(app, ["promote", "2", "--reason", "looks fine", "--data", str(copied)])
    assert result.exit_code == 0
    assert "the next one does it" in result.output
    listed = RUN.invoke(app, ["list", "--data", str(copied)])
    assert "promote round 2 (looks fine): not done yet" in listed.output
