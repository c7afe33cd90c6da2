"""Things that are told by their sides: both sides in the same forms, of pairs that lie apart."""

from services.learner.experiments import sides
from shared.evaluation.scene import Setting, prepare
from shared.messages.goal import LanguageGoal
from shared.policies.checkpoint import bundled
from shared.policies.low_level import LowLevel
from shared.workcell.env import WorkcellEnv, objects, proprioception
from shared.workcell.objects import index
from tests.unit.experiments.bench import here


def test_both_sides_are_told_in_the_same_forms() -> None:
    pair = sides.Pair(Setting(seed=1, task="bus"), "dish", ("saucer", "glass"))
    told = pair.trials()
    assert len(told) == len(sides.FORMS) * len(sides.BEFORE) * len(sides.SIDES)
    by_phrase = {trial.phrase: (trial.expected, one) for trial, one in told.items()}
    expected, one = by_phrase["no, the dish that is not on the right"]
    assert (expected, one.side, one.opposite) == (
        "pick up the saucer",
        "left",
        "pick up the glass",
    )
    expected, one = by_phrase["not the left dish, the right one"]
    assert (expected, one.opposite) == ("pick up the glass", "pick up the saucer")
    forms = {side: [one.form for one in told.values() if one.side == side] for side in sides.SIDES}
    assert forms["left"] == forms["right"]


def test_pairs_are_two_things_that_lie_apart(tmp_path) -> None:
    found = sides.pairs(here(tmp_path, (0, 4)))
    assert 0 < len(found) <= 4
    env = WorkcellEnv()
    for pair in found:
        prepare(env, pair.setting)
        left, right = (env.state.points[index(name)][0] for name in pair.things)
        assert right - left > sides.APART_M
    env.close()


def test_the_bundled_low_level_takes_the_thing_on_the_side_that_is_named(tmp_path) -> None:
    """By reading alone: of 96 it read all right on 2026-12-01, and none as the other side."""
    told = {
        trial: one
        for pair in sides.pairs(here(tmp_path, (0, 16)))
        for trial, one in pair.trials().items()
    }
    low_level, env = LowLevel.load(bundled("low_level")), WorkcellEnv()
    read = {}
    for trial in told:
        prepare(env, trial.setting)
        goal, there = LanguageGoal(text=trial.phrase), objects(env.state)
        assert low_level.objection(proprioception(env.state), there, goal) == ""
        read[trial] = low_level.meaning(goal, there)
    env.close()
    assert len(told) >= 64
    assert sum(read[trial] == trial.expected for trial in told) >= 0.95 * len(told)
    assert [trial.phrase for trial, one in told.items() if read[trial] == one.opposite] == []
