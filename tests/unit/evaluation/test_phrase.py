"""One phrase in one scene, with the bundled low level."""

import pytest

from shared.errors import WorkcellError
from shared.evaluation.phrase import Phrases, Speaker, Trial, contrary
from shared.evaluation.scene import Setting, prepare
from shared.workcell.env import WorkcellEnv
from shared.workcell.objects import index

SEED = 42


@pytest.fixture(scope="module")
def speaker():
    speaker = Speaker(Phrases())
    yield speaker
    speaker.close()


@pytest.fixture(scope="module")
def env():
    return WorkcellEnv(max_steps=10_000)


def trial(phrase="", holding="", lead=0, **fields):
    setting = Setting(seed=SEED, task="sandwich", holding=holding, lead=lead)
    return Trial(setting=setting, phrase=phrase, **fields)


def test_a_phrase_in_other_words_is_understood_and_done(speaker):
    said = speaker(trial("grab the cheese"))
    assert said.nearest[0].command == "pick up the cheese"
    assert said.achieved == said.expected == "pick up the cheese"
    assert 10 < said.steps < 120
    assert said.success


def test_with_something_in_the_hand_it_can_be_put_somewhere(speaker):
    said = speaker(trial("put it in the bin", holding="ham"))
    assert said.achieved == "put it in the bin"


def test_what_wasnt_said_isnt_success(speaker):
    said = speaker(trial("pick up the cheese", expected="pick up the ham", steps=80))
    assert said.achieved == "pick up the cheese"
    assert not said.success


def test_to_wait_is_to_have_done_nothing(speaker):
    assert speaker(trial("wait", steps=20)).achieved == "wait"


def test_to_wait_with_something_in_the_hand_is_not_to_pick_it_up(speaker):
    said = speaker(trial("wait", holding="ham", steps=30))
    assert (said.achieved, said.done) == ("wait", ("wait",))


def test_a_phrase_that_the_low_level_objects_to_moves_nothing(speaker):
    class Refusing:
        def objection(self, proprioception, objects, goal):
            del proprioception, objects
            return f"no {goal.text}"

        def nearest(self, proprioception, objects, goal):
            del proprioception, objects, goal
            return [("pick up the ham", 0.4)]

        def meaning(self, goal, objects):
            del goal, objects

    willing, speaker._low_level = speaker._low_level, Refusing()
    said = speaker(trial("pick up the banana"))
    speaker._low_level = willing
    assert (said.refused, said.achieved, said.steps) == ("no pick up the banana", None, 0)
    assert said.nearest == (("pick up the ham", 0.4),)


def test_a_contrary_command_can_be_obeyed_and_isnt_right(env):
    for lead in (0, 1, 2, 3):
        previous = prepare(env, Setting(seed=SEED, task="sandwich", lead=lead))
        fine = env.task.acceptable_commands(env.state, env.brief, previous)
        said = contrary(env.state, fine, lead)
        assert said not in fine
        assert said.startswith("put" if lead % 2 else "pick up")


def test_a_lead_is_the_work_of_the_task_so_far(env):
    prepare(env, Setting(seed=SEED, task="sandwich", lead=3))
    assert env.state.holding
    assert env.task.progress(env.state, env.brief) == 0.25
    prepare(env, Setting(seed=SEED, task="sandwich", holding="onion"))
    assert env.state.holding == {index("onion")}


def test_a_scene_is_looked_for_in_which_a_command_can_be_obeyed(env):
    prepare(env, Setting(seed=SEED, holding="anything", lead=2, fits="put it in the bin"))
    assert env.state.holding
    prepare(env, Setting(seed=SEED, fits="pick up the ham"))
    assert not env.state.holding


def test_equal_settings_make_equal_scenes(env):
    setting = Setting(seed=SEED, task="pack", lead=1)
    prepare(env, setting)
    first = env.state.to_json()
    prepare(env, setting)
    assert env.state.to_json() == first


def test_an_unknown_thing_or_task_is_an_error_that_names_what_is_known(env):
    with pytest.raises(ValueError, match="ham"):
        Setting(seed=SEED, task="sandwich", holding="hamm")
    with pytest.raises(WorkcellError, match="sandwich"):
        prepare(env, Setting(seed=SEED, task="dance"))
