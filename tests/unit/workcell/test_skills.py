"""Words for skills, and when a skill is achieved."""

import pytest

from shared.workcell.errors import UnknownCommand
from shared.workcell.measure import attempt
from shared.workcell.skills import COMMANDS, PARAPHRASES, Skill, achieved, parse


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_reads_back_as_its_skill(command):
    assert parse(command).text == command
    assert parse(f"  {command.upper()} ").text == command


def test_an_unknown_command_is_answered_with_the_nearest_ones():
    with pytest.raises(UnknownCommand, match="pick up the cheese"):
        parse("pick up the chese")


def test_every_command_has_at_least_eight_paraphrases_that_mean_it_alone():
    said = [text for texts in PARAPHRASES.values() for text in texts]
    assert tuple(PARAPHRASES) == COMMANDS
    assert all(len(texts) >= 8 for texts in PARAPHRASES.values())
    assert len(said) == len(set(said))


def test_a_put_with_empty_hands_is_never_achieved(cell):
    state = cell.state()
    assert not any(achieved(Skill(verb), state, state) for verb in ("plate", "bin", "down"))
    assert achieved(Skill("wait"), state, state)


@pytest.mark.parametrize("put", COMMANDS[7:10])
def test_the_expert_achieves_a_pick_and_then_a_put(cell, put):
    assert attempt(cell, "pick up the ham") is not None
    assert attempt(cell, put) is not None
