"""Words for skills, and when a skill is achieved."""

import numpy as np
import pytest

from shared.workcell.errors import UnknownCommand
from shared.workcell.measure import attempt
from shared.workcell.objects import KINDS, OBJECT_NAMES, TABLE
from shared.workcell.skills import (
    COMMANDS,
    PUT_DOWN,
    PUT_IN_BIN,
    PUT_IN_TUB,
    PUT_ON_PLATE,
    Skill,
    achieved,
    is_there,
    parse,
    possible,
)


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_reads_back_as_its_skill(command):
    assert parse(command).text == command
    assert parse(f"  {command.upper()} ").text == command


def test_an_unknown_command_is_answered_with_the_nearest_ones():
    with pytest.raises(UnknownCommand, match="pick up the cheese"):
        parse("pick up the chese")


def test_a_put_with_empty_hands_is_never_achieved(cell):
    state = cell.state()
    assert not any(achieved(Skill(verb), state, state) for verb in ("plate", "bin", "tub", "down"))
    assert achieved(Skill("wait"), state, state)


@pytest.mark.parametrize("put", [PUT_ON_PLATE, PUT_IN_BIN, PUT_DOWN])
def test_the_expert_achieves_a_pick_and_then_a_put(cell, put):
    assert attempt(cell, "pick up the ham") is not None
    assert attempt(cell, put) is not None


@pytest.mark.parametrize("name", sorted(TABLE & set(OBJECT_NAMES)))
def test_the_expert_clears_each_thing_from_the_table(cell, name):
    cell.reset(np.random.default_rng(4), TABLE)
    put = PUT_IN_TUB if name in KINDS["dish"] else PUT_IN_BIN
    assert attempt(cell, f"pick up the {name}") is not None
    assert attempt(cell, put) is not None


def test_what_is_not_on_the_table_cannot_be_done_and_moves_nothing(cell):
    state = cell.state()
    for command in ("pick up the cup", PUT_IN_TUB):
        assert not is_there(parse(command), state)
    assert is_there(parse(PUT_IN_BIN), state)
    assert not possible(parse(PUT_IN_BIN), state)  # Nothing is held.
    assert possible(parse("pick up the ham"), state)
    assert attempt(cell, "pick up the cup", steps=30) is None
    assert not cell.state().holding
