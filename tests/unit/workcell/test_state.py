"""What follows from the true state."""

import json

import numpy as np
import pytest

from shared.workcell.errors import InvalidState
from shared.workcell.layout import BIN, BIN_FLOOR_M, PLATE_TOP_M, PLATE_XY
from shared.workcell.objects import HALF_HEIGHTS_M, index
from shared.workcell.state import (
    CellState,
    astray_on_plate,
    cover_of,
    in_bin,
    on_table,
    stack_on_plate,
)

BREAD, CHEESE, HAM = index("bread"), index("cheese"), index("ham")


def edited(state, item, position=None, quaternion=None, held=None):
    """A copy of a state with one object elsewhere."""
    arrays = {name: array.copy() for name, array in state.to_arrays().items()}
    if position is not None:
        arrays["positions"][item] = position
    if quaternion is not None:
        arrays["quaternions"][item] = quaternion
    if held is not None:
        arrays["held"][held] = item
    return CellState.from_arrays(arrays)


def on_plate(state, item, below=0.0, off=0.0):
    """The object flat on the plate, `below` being the height of what lies under it."""
    x, y = PLATE_XY
    height = PLATE_TOP_M + below + HALF_HEIGHTS_M[item]
    return edited(state, item, (x + off, y, height), (1, 0, 0, 0))


@pytest.mark.parametrize("way", ["arrays", "json"])
def test_a_state_survives_travelling_to_the_bit(cell, way):
    state = cell.state()
    if way == "arrays":
        back = CellState.from_arrays(state.to_arrays())
    else:
        back = CellState.from_json(json.loads(json.dumps(state.to_json())))
    for name, array in state.to_arrays().items():
        assert back.to_arrays()[name].tobytes() == array.tobytes()


def test_arrays_that_are_no_state_are_refused_by_name(cell):
    arrays = cell.state().to_arrays()
    with pytest.raises(InvalidState, match="joints is float64"):
        CellState.from_arrays(arrays | {"joints": np.zeros(3)})
    with pytest.raises(InvalidState, match="a state has joints"):
        CellState.from_arrays({"joints": arrays["joints"]})
    with pytest.raises(InvalidState, match="lists of numbers"):
        CellState.from_json(cell.state().to_json() | {"tools": [["far"]]})


def test_a_stack_is_read_from_bottom_to_top(cell):
    state = on_plate(cell.state(), BREAD)
    state = on_plate(state, CHEESE, below=2 * HALF_HEIGHTS_M[BREAD], off=0.01)
    assert stack_on_plate(state) == (BREAD, CHEESE)
    assert astray_on_plate(state) == ()


def test_what_lies_askew_on_the_plate_is_astray_and_no_part_of_the_stack(cell):
    state = on_plate(on_plate(cell.state(), BREAD), CHEESE, off=0.07)
    assert stack_on_plate(state) == (BREAD,)
    assert astray_on_plate(state) == (CHEESE,)


def test_a_held_object_over_the_bin_is_not_in_it(cell):
    at = (BIN.x_m, BIN.y_m, BIN_FLOOR_M + HALF_HEIGHTS_M[HAM])
    lying = edited(cell.state(), HAM, at)
    assert in_bin(lying) == {HAM}
    assert in_bin(edited(lying, HAM, held=0)) == frozenset()


def test_an_object_on_another_covers_it(cell):
    state = cell.state()
    x, y, z = state.positions[HAM]
    covered = edited(state, CHEESE, (x + 0.01, y, z + 0.014))
    assert cover_of(covered, HAM) == CHEESE
    assert cover_of(covered, CHEESE) is None


def test_at_the_start_all_lies_on_the_table_in_reach_and_apart(cell):
    for seed in range(20):
        cell.reset(np.random.default_rng(seed))
        state = cell.state()
        spots = state.positions[:7, :2]
        gaps = np.linalg.norm(spots[:, None] - spots[None], axis=2) + np.eye(7)
        assert all(on_table(state, item) for item in range(7))
        assert gaps.min() > 0.09
