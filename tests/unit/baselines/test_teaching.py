"""What the arms learn from: the same for all, and for those without words no word of it."""

import numpy as np
import pytest

from services.learner.baselines.data import SILENT, Teaching, join, lessons_of
from services.learner.baselines.scale import ARMS
from services.learner.pretrain.practice import DECISION_STEPS, EXECUTE_STEPS
from shared.workcell.skills import COMMANDS
from tests.unit.baselines.taught import teaching


def test_the_steps_of_a_decision_are_those_under_its_command():
    taught = teaching()
    lengths = np.diff(taught.decisions.windows)[:, 0]
    assert lengths.min() == 0 < lengths.max() == DECISION_STEPS
    assert lengths.sum() == len(taught.steps)
    for label, (first, end) in zip(
        taught.decisions.seen.examples.labels, taught.decisions.windows, strict=True
    ):
        assert {COMMANDS[row] for row in taught.steps.commands[first:end]} <= {label}


def test_a_moment_is_felt_as_it_is_at_its_first_step():
    taught = teaching()
    first, end = taught.moments.windows.T
    assert (end > first).all()
    felt = taught.steps.proprioception[first]
    assert np.array_equal(taught.moments.seen.examples.senses, felt)


def test_a_part_is_read_back_as_it_was(tmp_path):
    taught = teaching()
    taught.save(tmp_path / "part")
    assert Teaching.load(tmp_path / "part").sha256() == taught.sha256()


def test_joined_parts_keep_looks_and_steps_together():
    taught = teaching()
    both = join([taught, taught])
    count = len(taught.decisions)
    assert np.array_equal(
        both.decisions.windows[count:], taught.decisions.windows + len(both.steps) // 2
    )
    assert both.sha256() != taught.sha256()
    assert len(set(both.steps.runs)) == 2 * len(set(taught.steps.runs))


@pytest.mark.parametrize("arm", ARMS)
def test_an_arm_gets_words_only_if_its_goals_are_words(arm):
    looks, steps = lessons_of(teaching(), arm)
    worded = arm in ("hierarchy", "chain")
    labelled = worded or arm == "guided"
    assert (set(looks.seen.examples.labels) == {SILENT}) is not labelled
    assert any(looks.seen.examples.previous) is worded
    assert (len(set(steps.commands)) > 1) is worded
    assert len(steps) == len(teaching().steps)


def test_a_run_of_a_worded_arm_has_one_command():
    _, steps = lessons_of(teaching(), "hierarchy")
    for run in set(steps.runs):
        assert len(set(steps.commands[steps.runs == run])) == 1


def test_the_flat_arm_sees_no_more_than_one_look_for_one_chunk():
    looks, _ = lessons_of(teaching(), "flat")
    assert len(looks) == len(teaching().decisions) + len(teaching().moments)
    assert (looks.seen.examples.looks[:, :-1] == -1).all()
    assert np.diff(looks.windows).max() == EXECUTE_STEPS
