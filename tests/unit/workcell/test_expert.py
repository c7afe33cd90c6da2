"""The scripted expert of the low level."""

import numpy as np
import pytest

from shared.workcell.cell import ACTION_HIGH, ACTION_LOW
from shared.workcell.expert import HOME, JOINT_RAD, act
from shared.workcell.measure import attempt
from shared.workcell.objects import OBJECT_NAMES, index
from shared.workcell.skills import COMMANDS, SKILLS, parse
from shared.workcell.state import CellState, in_bin, on_table


@pytest.mark.parametrize("skill", SKILLS)
def test_the_same_state_gives_the_same_action_whatever_came_between(cell, skill):
    state = cell.state()
    first = act(state, skill)
    act(state, parse(COMMANDS[3]))
    again = act(CellState.from_arrays(state.to_arrays()), skill)
    assert first.shape == (14,)
    assert first.tobytes() == again.tobytes()


def test_no_target_leaves_the_limits_or_jumps_in_any_state(cell):
    rng = np.random.default_rng(3)
    for step in range(200):
        state = cell.state()
        action = act(state, SKILLS[step // 40])
        moved = np.abs(action - state.joints).reshape(2, 7)[:, :6]
        assert (action >= ACTION_LOW - 1e-9).all()
        assert (action <= ACTION_HIGH + 1e-9).all()
        assert moved.max() <= JOINT_RAD + 1e-9
        cell.step(action + rng.normal(0, 0.05, 14))


@pytest.mark.parametrize("spot", [(0.05, 0.0, 0.1), (-0.3, -0.2, 0.1), (0.0, 0.17, 0.1)])
def test_an_object_dropped_anywhere_is_picked_up_again(cell, spot):
    cell.place("tomato", spot, yaw=0.7)
    assert attempt(cell, "wait", 1) == 0
    assert attempt(cell, "pick up the tomato", 200) is not None


def test_asked_for_another_object_it_first_puts_down_the_one_it_holds(cell):
    assert attempt(cell, "pick up the onion") is not None
    assert attempt(cell, "pick up the bread", 200) is not None
    assert on_table(cell.state(), index("onion"))


def test_an_object_in_the_corner_of_the_bin_can_be_taken_out(cell):
    cell.place("cheese", (0.07, 0.235, 0.05))
    assert index("cheese") in in_bin(cell.state())
    assert attempt(cell, "pick up the cheese", 200) is not None
    assert attempt(cell, "put it down") is not None


def test_waiting_arms_go_home_and_keep_what_they_hold(cell):
    name = OBJECT_NAMES[2]
    assert attempt(cell, f"pick up the {name}") is not None
    for _ in range(80):
        cell.step(act(cell.state(), parse("wait")))
    state = cell.state()
    assert state.holding == {index(name)}
    assert state.tools[:, :3] == pytest.approx(np.array(HOME), abs=0.01)
