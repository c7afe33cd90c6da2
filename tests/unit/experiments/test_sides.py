"""Things that are told by their sides: both sides in the same forms, of pairs that lie apart."""

from services.learner.experiments import sides
from shared.evaluation.scene import Setting, prepare
from shared.workcell.env import WorkcellEnv
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
