"""What a phrase names is told by how things lie, in scenes of the real cell."""

from collections.abc import Iterator

import pytest

from shared.evaluation.phrase import Phrases, Said, Speaker, Trial
from shared.evaluation.scene import Setting, prepare
from shared.workcell.objects import KINDS, OBJECT_NAMES, index
from shared.workcell.state import cover_of, stack_on_plate


@pytest.fixture(scope="module")
def speaker() -> Iterator[Speaker]:
    speaker = Speaker(Phrases())
    yield speaker
    speaker.close()


def say(speaker: Speaker, phrase: str, seed: int, task: str, lead: int = 0) -> Said:
    setting = Setting(seed=seed, task=task, lead=lead)
    return speaker(Trial(setting=setting, phrase=phrase, steps=120))


@pytest.mark.parametrize("seed", [1, 4, 5, 8])
def test_left_and_right_are_the_outer_dishes(speaker: Speaker, seed: int) -> None:
    prepare(speaker._env, Setting(seed=seed, task="bus"))
    state = speaker._env.state
    there = [name for name in KINDS["dish"] if state.present[index(name)]]
    there.sort(key=lambda name: state.points[index(name)][0])
    for side, name in (("left", there[0]), ("right", there[-1])):
        said = say(speaker, f"take the dish on the {side}", seed, "bus")
        assert (said.refused, said.achieved) == ("", f"pick up the {name}")


def test_a_red_dish_is_the_cup(speaker: Speaker) -> None:
    assert say(speaker, "the red dish", 3, "bus").achieved == "pick up the cup"


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_what_lies_in_a_stack_is_refused_with_what_lies_on_it(speaker: Speaker, seed: int) -> None:
    prepare(speaker._env, Setting(seed=seed, task="sandwich", lead=8))
    state = speaker._env.state
    *below, top = stack_on_plate(state)
    assert len(below) == 3
    assert speaker.read(f"pick up the {OBJECT_NAMES[top]}").refused == ""
    for row in below:
        assert cover_of(state, row) == top
        refused = speaker.read(f"take the {OBJECT_NAMES[row]}").refused
        first = OBJECT_NAMES[top]
        assert f"the {first} lies on it: 'pick up the {first}' first" in refused


def test_what_lies_on_the_table_is_free(speaker: Speaker) -> None:
    for seed, task in ((0, "sandwich"), (1, "pack"), (2, "bus")):
        prepare(speaker._env, Setting(seed=seed, task=task))
        for row in range(len(OBJECT_NAMES)):
            if speaker._env.state.present[row]:
                assert speaker.read(f"pick up the {OBJECT_NAMES[row]}").refused == ""
