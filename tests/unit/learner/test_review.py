"""`hld review`: what is open, and what settles it."""

import json
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from services.learner.labels.aggregate import LabelSettings, derive
from services.learner.labels.review import Review, review
from services.learner.questions import app
from services.learner.store.sql import SqlStore, sqlite_url
from services.learner.store.store import Manifest
from shared.messages.correction import Kind
from tests.unit.learner.records import (
    CHEESE,
    HAM,
    LOW,
    TOAST,
    correction,
    episode,
    every_20,
    history_of,
    receipt,
    ruling,
)
from tests.unit.learner.test_versions import record

RUN = CliRunner(env={"COLUMNS": "80"})
GRAB = "grab the yellow slice"
KNOWN = (CHEESE, HAM, TOAST)


def said(id_: str, text: str, author: str, step: int = 40) -> list[Any]:
    fields = {"author": author, "decision": f"e-1-{step}", "hold_steps": 5}
    return [correction(id_, text, **fields), receipt(id_, step)]


def meaning(phrase: str) -> str | None:
    return {GRAB: CHEESE, "get the ham": HAM}.get(phrase)


def reviewed(*messages: Any) -> Review:
    history = history_of(*every_20(100), episode(), *messages)
    return review(history, LabelSettings(), KNOWN, meaning)


def test_a_contradiction_names_both_people_and_all_they_disagree_about() -> None:
    span = {"first_step": 20, "end_step": 80}
    both = [
        correction("a", HAM, kind="relabel", author="ada", **span),
        correction("b", TOAST, kind="relabel", author="bob", **span),
    ]
    (found,) = reviewed(*both).contradictions
    assert (found.episode, found.steps) == ("e-1", (20, 60))
    assert found.decisions == ("e-1-20", "e-1-40", "e-1-60")
    assert [(one.author, one.correction, one.text) for one in (found.one, found.other)] == [
        ("ada", "a", HAM),
        ("bob", "b", TOAST),
    ]
    assert reviewed(*both, correction("r", kind="retract", target="a")).contradictions == ()


def test_a_phrase_that_is_read_as_a_command_is_asked_about_until_somebody_rules() -> None:
    words = [*said("a", GRAB, "ada"), *said("b", "Grab the yellow slice.", "ada", 60)]
    words += [*said("c", "fly", "ada", 80), *said("d", HAM, "ada", 20)]
    (found,) = reviewed(*words).wordings
    assert (found.phrase, found.means, found.times) == (GRAB, CHEESE, 2)
    for verb in ("alias", "distinct"):
        ruled = ruling("r", verb=verb, phrase=GRAB, means=CHEESE)
        assert reviewed(*words, ruled).wordings == ()
    other = ruling("r", verb="distinct", phrase=GRAB, means=HAM)
    assert reviewed(*words, other).wordings == (found,)


@pytest.fixture
def data(tmp_path: Path) -> Path:
    """A run in which two people contradict each other, and one uses words of their own."""
    with closing(SqlStore(sqlite_url(tmp_path / "learner.db"))) as store:
        first = record(0).model_copy(update={"bank": KNOWN, "epoch": store.take_over("l", 1)})
        store.found(first)
        words = [*said("a", HAM, "ada"), *said("b", TOAST, "bob"), *said("c", GRAB, "ada", 80)]
        fault = correction("f", kind="fault", decision="e-1-0")
        for message in (*every_20(100), *words, fault, episode()):
            store.add(message, 1)
    return tmp_path


def run(data: Path, *arguments: str) -> Any:
    return RUN.invoke(app, [*arguments, "--data", str(data)])


def labels(data: Path) -> dict[str, str]:
    with closing(SqlStore(sqlite_url(data / "learner.db"))) as store:
        history = store.history(Manifest(marks=store.survey(Manifest()).marks))
    return {label.decision: label.text for label in derive(history, LabelSettings(), LOW)}


def test_the_list_tells_what_is_open_within_80_columns(data: Path) -> None:
    result = run(data, "list", "--report", str(data / "r.json"))
    assert result.exit_code == 0, result.output
    assert max(map(len, result.output.splitlines())) <= 80
    for text in ("e-1", "step 40", "ada", "bob", HAM, TOAST, GRAB, CHEESE, "low level: 1"):
        assert text in result.output
    told = json.loads((data / "r.json").read_text())
    assert [one["author"] for one in told["contradictions"][0]["said"]] == ["ada", "bob"]
    assert told["wordings"] == [{"phrase": GRAB, "means": CHEESE, "times": 1}]
    assert told["faults"] == 1


@pytest.mark.parametrize("which", ["1", "e-1"])
def test_to_settle_is_to_take_back_what_contradicts_the_one_to_keep(data: Path, which: str) -> None:
    assert "e-1-40" not in labels(data)
    result = run(data, "settle", which, "--keep", "b", "--reason", "ada was tired")
    assert (result.exit_code, result.output.strip()) == (0, "taken back: a of ada")
    assert labels(data)["e-1-40"] == TOAST
    with closing(SqlStore(sqlite_url(data / "learner.db"))) as store:
        kept = store.history(Manifest(marks=store.survey(Manifest()).marks)).corrections
    (back,) = (one for one in kept if one.kind is Kind.RETRACT)
    assert (back.target, back.note, back.author) == ("a", "ada was tired", "person")


def test_an_alias_is_in_the_labels_from_then_on(data: Path) -> None:
    assert labels(data)["e-1-80"] == GRAB
    assert run(data, "alias", GRAB, CHEESE, "--reason", "the only one").exit_code == 0
    assert labels(data)["e-1-80"] == CHEESE
    assert run(data, "distinct", GRAB, CHEESE).exit_code == 0
    assert labels(data)["e-1-80"] == GRAB


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        (["settle", "7", "--keep", "a"], "no contradiction 7; there are 1 to 1, in e-1"),
        (["settle", "0", "--keep", "a"], "no contradiction 0"),
        (["settle", "1", "--keep", "c"], "c is in no contradiction 1; nearest known: 'a', 'b'"),
        (["alias", HAM, HAM], "can't be another wording of itself"),
        (["alias", "", HAM], "phrase: String should have at least 1 character"),
    ],
)
def test_what_cannot_be_settled_is_told_with_what_can(
    data: Path, arguments: list[str], why: str, capfd: pytest.CaptureFixture[str]
) -> None:
    result = run(data, *arguments)
    assert result.exit_code == 2
    assert why in result.output + capfd.readouterr().err
