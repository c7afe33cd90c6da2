"""Manifests say which code made what came of them."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from services.learner import code
from services.learner.code import DECIDING, LIBRARIES, code_version
from services.learner.rounds import next_manifest, take_stock
from services.learner.store.store import Marks
from shared.code import ROOT

STEPS = ("train", "gate", "trials", "canary", "turn", "loop")
"""Modules of the learner from which everything else of a round is imported."""


def sources(folder: Path, text: str) -> Path:
    for pattern in DECIDING:
        file = folder / pattern.replace("**/", "deep/").replace("*", "part")
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    return folder


def test_equal_sources_have_one_version_and_another_letter_another_one(tmp_path: Path) -> None:
    one, same = sources(tmp_path / "one", "a = 1\n"), sources(tmp_path / "same", "a = 1\n")
    other = sources(tmp_path / "other", "a = 2\n")
    assert code_version(one) == code_version(same)
    assert code_version(one) != code_version(other)


def test_another_version_of_a_library_that_computes_is_another_code(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    one, same = sources(tmp_path / "one", "a = 1\n"), sources(tmp_path / "same", "a = 1\n")
    before = code_version(one)
    monkeypatch.setattr(code, "version", lambda name: "9.9" if name == "torch" else "1.0")
    assert code_version(same) != before


def test_the_libraries_that_are_named_are_there() -> None:
    assert [name for name in LIBRARIES if code._version(name) == "unreleased"] == []


def test_a_manifest_names_the_code_that_is_running() -> None:
    manifest = next_manifest(Marks(), take_stock((), 0, 0), {})
    assert manifest.code == code_version()
    assert len(manifest.code.split()) == 2


def test_all_that_a_round_imports_is_hashed() -> None:
    hashed = {file for pattern in DECIDING for file in ROOT.glob(pattern)}
    todo = [ROOT / "services" / "learner" / f"{name}.py" for name in STEPS]
    todo.append(ROOT / "services" / "actor" / "trials.py")
    seen = set[Path]()
    while todo:
        file = todo.pop()
        if file not in seen:
            seen.add(file)
            todo.extend(imported(file))
    assert len(seen) > 100
    assert {file for file in seen - hashed if file.read_text().strip()} <= {
        ROOT / "services" / "__init__.py"
    }
    assert {ROOT / "shared" / "workcell" / "sites" / "far.toml"} <= hashed


def imported(file: Path) -> Iterator[Path]:
    """The files of ours that one imports, wherever in it."""
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names = [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
        else:
            continue
        for name in names:
            place = ROOT.joinpath(*name.split("."))
            found = (place.with_suffix(".py"), place / "__init__.py")
            yield from (one for one in found if one.is_file())
