"""What a README says is there is there."""

import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from deploy.hld import app

ROOT = Path(__file__).parents[2]
READMES = sorted(
    path
    for path in ROOT.rglob("README.md")
    if not {".venv", "node_modules", "runs"} & set(path.parts)
)
LINK = re.compile(r"\]\(([^)#:]+)\)")
GENERATED = ROOT / "shared" / "checkpoints"  # Model cards, written by the code that trains.


@pytest.mark.parametrize("path", READMES, ids=lambda path: str(path.relative_to(ROOT)))
def test_every_link_leads_somewhere(path):
    broken = [link for link in LINK.findall(path.read_text()) if not (path.parent / link).exists()]
    assert not broken


@pytest.mark.parametrize("path", READMES, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_rooms_readme_is_read_in_two_minutes(path):
    if path.parent != ROOT and GENERATED not in path.parents:
        assert len(path.read_text().splitlines()) <= 60


def test_every_room_has_a_readme():
    rooms = [
        *(path for path in (ROOT / "shared").iterdir() if path.is_dir()),
        *(path for path in (ROOT / "services").iterdir() if path.is_dir()),
        ROOT / "deploy",
    ]
    bare = [
        str(room.relative_to(ROOT))
        for room in rooms
        if room.name != "__pycache__" and room != GENERATED and not (room / "README.md").exists()
    ]
    assert not bare


def test_every_command_that_the_readme_shows_exists():
    shown = set(re.findall(r"\bhld ([a-z]+)\b", (ROOT / "README.md").read_text()))
    listed = CliRunner().invoke(app, ["--help"]).output
    assert shown
    assert {name for name in shown if not re.search(rf"\b{name}\b", listed)} == set()


def test_the_options_of_hld_up_that_the_readme_shows_exist():
    text = (ROOT / "README.md").read_text()
    shown = set(re.findall(r"(--[a-z-]+)", re.search(r"hld up (.*)", text).group(1)))
    result = CliRunner().invoke(app, ["up", "--help"], env={"COLUMNS": "200"})
    assert {option for option in shown if option not in result.output} == set()


def test_the_tests_that_the_method_names_are_there():
    method = (ROOT / "docs" / "method.md").read_text()
    named = set(re.findall(r"`(test_\w+)`", method))
    files = (ROOT / "tests").rglob("test_*.py")
    there = {name for file in files for name in re.findall(r"def (test_\w+)", file.read_text())}
    assert len(named) > 40
    assert named <= there, f"docs/method.md names tests that are not there: {named - there}"
