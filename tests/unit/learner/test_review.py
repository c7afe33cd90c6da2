"""`hld review`: what is open, and what settles it."""

import json
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from services.learner.labels.account import faults
from services.learner.labels.aggregate import LabelSettings, derive
from services.learner.labels.review import Review, review
from services.learner.questions import app, rest
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


def test_of_a_relabel_only_the_steps_that_are_contradicted_are_taken_back(tmp_path: Path) -> None:
    span = {"kind": "relabel", "author": "bob"}
    with closing(SqlStore(sqlite_url(tmp_path / "learner.db"))) as store:
        store.found(record(0).model_copy(update={"bank": KNOWN, "epoch": store.take_over("l", 1)}))
        wide = correction("b", TOAST, first_step=0, end_step=100, created_ns=5, **span)
        later = correction("d", CHEESE, first_step=80, end_step=90, created_ns=6, **span)
        for message in (*every_20(100), *said("a", HAM, "ada"), wide, later, episode()):
            store.add(message, 1)
    assert "e-1-40" not in labels(tmp_path)
    result = run(tmp_path, "settle", "1", "--keep", "a")
    assert result.output.splitlines() == [
        "taken back: b of bob",
        "kept of it: steps 0 to 39",
        "kept of it: steps 41 to 99",
    ]
    found = {int(name.rsplit("-", 1)[1]): text for name, text in labels(tmp_path).items()}
    assert found == {0: TOAST, 20: TOAST, 40: HAM, 60: TOAST, 80: CHEESE}
    with closing(SqlStore(sqlite_url(tmp_path / "learner.db"))) as store:
        kept = store.history(Manifest(marks=store.survey(Manifest()).marks)).corrections
    again = [one for one in kept if one.note and "but for what a contradicts" in one.note]
    assert [(one.author, one.span, one.created_ns) for one in again] == [
        ("bob", range(40), 5),
        ("bob", range(41, 100), 5),
    ]


def test_the_rest_of_a_fault_is_kept_too(tmp_path: Path) -> None:
    with closing(SqlStore(sqlite_url(tmp_path / "learner.db"))) as store:
        store.found(record(0).model_copy(update={"bank": KNOWN, "epoch": store.take_over("l", 1)}))
        late = [correction("a", HAM, decision="e-1-40", seen_step=40), receipt("a", 50)]
        blame = correction("f", kind="fault", author="bob", first_step=40, end_step=70)
        for message in (*every_20(100), *late, blame, episode()):
            store.add(message, 1)
    assert run(tmp_path, "settle", "e-1", "--keep", "a").exit_code == 0
    assert labels(tmp_path)["e-1-40"] == HAM
    with closing(SqlStore(sqlite_url(tmp_path / "learner.db"))) as store:
        history = store.history(Manifest(marks=store.survey(Manifest()).marks))
    (left,) = faults(history)
    assert (left.author, left.steps, left.decisions) == ("bob", range(41, 70), ("e-1-60",))


@given(
    st.integers(0, 30),
    st.integers(0, 30),
    st.lists(st.tuples(st.integers(0, 40), st.integers(0, 9)), max_size=4),
)
def test_the_rest_of_a_stretch_is_what_no_cut_has(
    first: int, length: int, cuts: list[tuple[int, int]]
) -> None:
    span = range(first, first + length)
    taken = [range(begin, begin + count) for begin, count in cuts]
    left = [*rest(span, taken)]
    assert all(len(one) for one in left)
    wanted = [step for step in span if not any(step in cut for cut in taken)]
    assert [step for one in left for step in one] == wanted


def test_an_alias_is_in_the_labels_from_then_on(data: Path) -> None:
    assert labels(data)["e-1-80"] == GRAB
    assert run(data, "alias", GRAB, CHEESE, "--reason", "the only one").exit_code == 0
    assert labels(data)["e-1-80"] == CHEESE
    assert run(data, "distinct", GRAB, CHEESE).exit_code == 0
    assert labels(data)["e-1-80"] == GRAB


def test_a_ruling_says_what_comes_of_it_or_that_nothing_does(
    data: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    def ruled(*arguments: str) -> tuple[int, str]:
        result = run(data, *arguments)
        told = capfd.readouterr()
        return result.exit_code, result.output + told.out + told.err

    assert ruled("alias", GRAB, HAM) == (0, f"from the next round on labels say “{HAM}” for both\n")
    assert ruled("alias", HAM, CHEESE)[0] == 0
    code, told = ruled("distinct", GRAB, CHEESE)
    assert (code, f"other aliases still make “{CHEESE}” of both" in told) == (0, True)
    # It is that already, the other way round.
    assert f"labels say “{CHEESE}” for both" in ruled("alias", CHEESE, GRAB)[1]
    assert labels(data)["e-1-80"] == CHEESE
    assert f"keep “{HAM}” and “{CHEESE}” apart" in ruled("distinct", HAM, CHEESE)[1]
    assert labels(data)["e-1-80"] == HAM


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
