"""Manifests say which code made what came of them."""

from pathlib import Path

from services.learner.code import DECIDING, code_version
from services.learner.rounds import next_manifest, take_stock
from services.learner.store.store import Marks


def sources(folder: Path, text: str) -> Path:
    for name in DECIDING:
        (folder / name).mkdir(parents=True)
        (folder / name / "part.py").write_text(text)
    return folder


def test_equal_sources_have_one_version_and_another_letter_another_one(tmp_path: Path) -> None:
    one, same = sources(tmp_path / "one", "a = 1\n"), sources(tmp_path / "same", "a = 1\n")
    other = sources(tmp_path / "other", "a = 2\n")
    assert code_version(one) == code_version(same)
    assert code_version(one) != code_version(other)


def test_a_manifest_names_the_code_that_is_running() -> None:
    manifest = next_manifest(Marks(), take_stock((), 0, 0), {})
    assert manifest.code == code_version()
    assert len(manifest.code.split()) == 2
