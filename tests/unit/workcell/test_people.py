"""People at the table: rare, seen, counted, and never in the robot's way."""

import numpy as np
import pytest

from shared.workcell.cell import Cell
from shared.workcell.expert import act
from shared.workcell.layout import PLATE_XY
from shared.workcell.measure import attempt
from shared.workcell.objects import BIN, COUNT, PLATE, index
from shared.workcell.people import Passers
from shared.workcell.site import People, load_site
from shared.workcell.skills import PUT_IN_BIN, PUT_ON_PLATE, parse
from shared.workcell.state import in_bin, stack_on_plate


@pytest.fixture(scope="module")
def cells():
    kept = {}

    def make(**rates):
        key = tuple(rates.items())
        if key not in kept:
            site = load_site("lab").model_copy(update={"people": People(**rates)})
            kept[key] = Cell(site)
        kept[key].reset(np.random.default_rng(0))
        return kept[key]

    yield make
    for cell in kept.values():
        cell.close()


def watch(cell, steps=300, target=("ham",)):
    """Arms rest; what people did."""
    passers = Passers(cell, np.random.default_rng(1))
    for _ in range(steps):
        cell.step(act(cell.state(), parse("wait")))
        passers.pass_by(cell.state(), target)
    return passers.count


def test_nobody_comes_by_where_the_site_has_no_people(cells):
    cell = cells()
    before = cell.state().positions.copy()
    assert watch(cell) == 0
    assert np.abs(cell.state().positions - before).max() < 0.002


def test_the_plate_is_moved_with_what_lies_on_it(cells):
    cell = cells(move_plate=60.0)
    attempt(cell, "pick up the ham")
    attempt(cell, PUT_ON_PLATE)
    assert watch(cell) > 0
    state = cell.state()
    assert np.hypot(*(state.positions[PLATE, :2] - PLATE_XY)) > 0.005
    assert stack_on_plate(state) == (index("ham"),)


def test_what_was_put_away_is_put_back_on_the_table(cells):
    cell = cells(put_back=60.0)
    attempt(cell, "pick up the ham")
    attempt(cell, PUT_IN_BIN)
    assert in_bin(cell.state()) == {index("ham")}
    assert watch(cell) > 0
    assert not in_bin(cell.state())


def test_a_thing_is_laid_elsewhere_upon_nothing_else(cells):
    cell = cells(move_thing=60.0)
    before = cell.state().positions[:COUNT].copy()
    assert watch(cell) > 0
    state = cell.state()
    moved = np.linalg.norm(state.positions[:COUNT, :2] - before[:, :2], axis=1) > 0.03
    assert moved.any()
    assert state.positions[:7, 2].max() < 0.02
    assert not in_bin(state)
    assert np.array_equal(state.positions[BIN, :2], (0.0, 0.165))
