"""Sites: settings files for where a cell stands."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError

from shared.workcell.cell import Cell
from shared.workcell.env import WorkcellEnv
from shared.workcell.errors import InvalidSite
from shared.workcell.expert import act
from shared.workcell.site import Prompts, Site, load_site, site_names
from shared.workcell.skills import achieved, parse


def test_the_sites_that_come_with_the_cell_load_under_their_own_names():
    assert site_names() == ("far", "lab", "near")
    assert [load_site(name).name for name in site_names()] == list(site_names())
    assert load_site("lab") == Site(name="lab", prompts=Prompts(constraints=0.3))


def test_an_unknown_site_is_answered_with_the_known_ones():
    with pytest.raises(InvalidSite, match="far, lab, near"):
        load_site("kitchen")


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ('name = "x"\nslip_rat = 0.1', "unknown key 'slip_rat'.*'slip_rate'"),
        ('name = "x"\n[light]\nlevle = 0.1', "unknown key 'light.levle'.*'level'"),
        ('name = "x"\nslip_rate = 2.0', "slip_rate: Input should be less"),
        ("name = ", "mine.toml"),
    ],
)
def test_a_site_that_says_something_wrong_is_refused_naming_it(tmp_path, text, complaint):
    path = tmp_path / "mine.toml"
    path.write_text(text)
    with pytest.raises(InvalidSite, match=complaint):
        load_site(path)


def test_a_missing_file_is_said_to_be_missing(tmp_path):
    with pytest.raises(InvalidSite, match="No such file"):
        load_site(tmp_path / "none.toml")


def test_a_site_cannot_be_changed():
    with pytest.raises(ValidationError):
        load_site("lab").slip_rate = 0.5


@pytest.mark.parametrize(("rate", "kept"), [(0.0, True), (0.2, False)])
def test_a_hand_loses_what_it_holds_only_where_the_site_says_so(rate, kept):
    cell = Cell(load_site("lab").model_copy(update={"slip_rate": rate}))
    cell.reset(np.random.default_rng(0))
    before, skill = cell.state(), parse("pick up the bread")
    while not achieved(skill, before, cell.state()):
        cell.step(act(cell.state(), skill))
    for _ in range(40):
        cell.step(act(cell.state(), parse("wait")))
    assert bool(cell.state().holding) is kept


def test_what_the_oracle_needs_loads_without_simulator():
    code = (
        "import sys; from shared.workcell import state, skills, expert, tasks, site;"
        "assert not {'mujoco', 'gymnasium', 'torch'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True, cwd=Path(__file__).parents[3])


def test_distractors_are_seen_and_never_touched():
    lab = load_site("lab")
    plain, full = (Cell(lab.model_copy(update={"distractors": count})) for count in (0, 8))
    for cell in (plain, full):
        cell.reset(np.random.default_rng(0))
    pictures = [cell.render("angle", 64, 64) for cell in (plain, full)]
    assert (pictures[0] != pictures[1]).any()
    assert np.array_equal(plain.state().positions, full.state().positions)
    for cell in (plain, full):
        cell.close()


@pytest.mark.parametrize(
    ("site", "opening"), [("near", "please|could|would"), ("far", "ok|hey|we|hello|right")]
)
def test_wishes_are_put_as_the_site_has_it(site, opening):
    draw = WorkcellEnv(site)
    for seed in range(4):
        draw.reset(seed=seed, options={"task": "pack"})
        assert re.match(opening, draw.brief.prompt)
    draw.close()
