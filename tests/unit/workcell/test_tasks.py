"""Prompts, success, and an oracle that knows what is to be done next."""

import numpy as np
import pytest

from shared.workcell import skills
from shared.workcell.errors import InvalidLength, UnknownPrompt, UnknownTask
from shared.workcell.expert import act
from shared.workcell.layout import BIN, PLATE_XY
from shared.workcell.measure import DECISION_STEPS, rollout
from shared.workcell.objects import OBJECT_NAMES, index
from shared.workcell.tasks import TASKS, Draw, task_named, understand


def carry_on(env, command=None):
    """Oracle and expert from here; whether the task ends well."""
    while True:
        if env.elapsed_steps % DECISION_STEPS == 0 or command is None:
            command = env.task.next_command(env.state, env.brief, command)
        _, _, terminated, truncated, _ = env.step(act(env.state, skills.parse(command)))
        if terminated or truncated:
            return terminated


def settle(env, steps=30):
    for _ in range(steps):
        env.step(act(env.state, skills.parse("wait")))


@pytest.mark.parametrize("manner", ["plain", "polite", "chatty"])
@pytest.mark.parametrize("name", TASKS)
def test_every_sampled_prompt_is_understood_as_what_it_was_drawn_for(name, manner):
    rng = np.random.default_rng(1)
    for _ in range(300):
        brief = TASKS[name].sample(rng, Draw(manner=manner, constraints=0.5))
        again = understand(brief.prompt)
        assert (again.task, again.wish, again.ordered) == (brief.task, brief.wish, brief.ordered)
        assert tuple(thing for thing in again.target if thing in brief.stock) == brief.target


@pytest.mark.parametrize("name", TASKS)
def test_an_episode_takes_as_many_skills_as_were_asked_for(name):
    rng = np.random.default_rng(2)
    for skills_ in TASKS[name].lengths:
        for _ in range(20):
            brief = TASKS[name].sample(rng, Draw(skills=skills_, constraints=0.5))
            assert brief.skills == skills_
            assert set(brief.target) <= brief.stock


def test_a_number_of_skills_that_a_task_cannot_take_is_refused_with_those_that_it_can():
    with pytest.raises(InvalidLength, match="a bus takes 2 to 16 skills, an even number; got 5"):
        TASKS["bus"].sample(np.random.default_rng(0), Draw(skills=5))


@pytest.mark.parametrize(
    ("prompt", "target"),
    [
        ("make a vegetarian sandwich", ("bread", "cheese", "lettuce", "tomato", "onion", "toast")),
        (
            "could you make a vegetarian sandwich, no tomato please",
            ("bread", "cheese", "lettuce", "onion", "toast"),
        ),
        ("pack everything brown into the bin", ("bread", "toast")),
        (
            "pack all the food except the ham and the onion into the bin",
            ("bread", "toast", "cheese", "lettuce", "tomato"),
        ),
        ("clear only the dishes but leave the glass", ("cup", "bowl", "saucer")),
        ("clear away everything red", ("cup", "can")),
        ("clear everything but the dishes", ("can", "wrapper", "carton", "napkin")),
        (
            "clear the table, not the red things",
            ("bowl", "glass", "saucer", "wrapper", "carton", "napkin"),
        ),
        ("clear everything except the dishes and the can", ("wrapper", "carton", "napkin")),
        ("pack everything that is not vegetarian into the bin", ("ham",)),
        (
            "make a sandwich without meat",
            ("bread", "cheese", "lettuce", "tomato", "onion", "toast"),
        ),
        ("make a sandwich with ham but no tomato", ("bread", "ham", "toast")),
        (
            "clear the table, not the red cup",
            ("bowl", "glass", "saucer", "can", "wrapper", "carton", "napkin"),
        ),
        ("pack everything that isn't red", ("bread", "toast", "cheese", "ham", "lettuce", "onion")),
        ("clear the things that aren’t dishes", ("can", "wrapper", "carton", "napkin")),
        ("clear everything which isn't white or red", ("bowl", "glass", "wrapper", "carton")),
        (
            "I'm allergic to cheese, make me a sandwich",
            ("bread", "ham", "lettuce", "tomato", "onion", "toast"),
        ),
        (
            "I don't like onion or ham, make me a sandwich with everything",
            ("bread", "cheese", "lettuce", "tomato", "toast"),
        ),
        ("make me a sandwich with ham, hold the onion", ("bread", "ham", "toast")),
        ("make a sandwich with nothing but cheese", ("bread", "cheese", "toast")),
        (
            "make a sandwich that doesn't have ham",
            ("bread", "cheese", "lettuce", "tomato", "onion", "toast"),
        ),
        ("I need the ham in the bin, nothing else", ("ham",)),
        ("bus the table", ("cup", "bowl", "glass", "saucer", "can", "wrapper", "carton", "napkin")),
    ],
)
def test_a_prompt_may_say_what_fits(prompt, target):
    assert understand(prompt).target == target


@pytest.mark.parametrize(
    "prompt",
    ["clear the left side", "clear the left", "clear the left-hand side", "clear the left things"],
)
def test_a_side_is_understood_without_its_preposition(prompt):
    assert understand(prompt).wish.sides == ("left",)


@pytest.mark.parametrize("side", ["left", "right"])
def test_sides_are_meant_as_things_lay_at_the_start(env, side):
    env.reset(seed=3, options={"prompt": f"pack only what is on the {side} into the bin"})
    there = {OBJECT_NAMES[row]: env.state.points[row][0] for row in range(7)}
    fitting = {name for name, x in there.items() if (x < 0) == (side == "left")}
    assert set(env.brief.target) == fitting
    assert 2 <= len(fitting) <= 5


@pytest.mark.parametrize(
    "prompt", ["pack the ham and the banana", "clear the table but leave a jar"]
)
def test_a_thing_that_the_cell_lacks_is_refused_with_those_that_it_has(prompt):
    with pytest.raises(
        UnknownPrompt, match=r"there is no '(banana|jar)' in this cell; it knows bread"
    ):
        understand(prompt)


@pytest.mark.parametrize(
    ("prompt", "why"),
    [
        ("clear what is not on the left", "side can't be left out"),
        ("put everything but what's on the right in the bin", "side can't be left out"),
        ("clear everything but the left side", "side can't be left out"),
        ("make a vegetarian sandwich with ham", "asks for meat"),
        ("a sandwich with ham but no ham", "'ham' is asked for and left out"),
        ("make a sandwich with ham, but no meat", "'ham' is asked for and left out"),
        ("pack the red things but nothing red", "'red' is asked for and left out"),
        ("pack everything on the left and the right", "both sides are everything"),
        ("clear everything on the left, and what is on the right", "both sides are everything"),
        ("clear both sides", "both sides are everything"),
        ("clear nothing", "leaves nothing to do; say what is to be done, such as 'clear"),
        ("make a sandwich with nothing", "what is left out reads like 'but not the cup'"),
        ("don't clear the table", "a prohibition is no wish"),
        ("clear everything, don't take the cup", "a prohibition is no wish"),
        ("make a sandwich, not too much ham", "what is left out reads like"),
        ("clear left", "a side reads like 'on the left'"),
    ],
)
def test_what_cant_be_meant_is_refused_once_with_the_reason(prompt, why):
    with pytest.raises(UnknownPrompt, match=why) as error:
        understand(prompt)
    assert str(error.value).count(why) == 1


@pytest.mark.parametrize(
    "prompt", ["", "dance", "make a sandwich with toast", "put the cup in the bin", "a sandwich"]
)
def test_a_prompt_that_asks_for_no_task_is_answered_with_one_that_does(prompt):
    with pytest.raises(UnknownPrompt, match="it reads like"):
        understand(prompt)


def test_an_unknown_task_is_answered_with_the_known_ones():
    with pytest.raises(UnknownTask, match="sandwich, pack"):
        task_named("juggle")


@pytest.mark.parametrize("name", TASKS)
@pytest.mark.parametrize("seed", [1, 2])
def test_oracle_and_expert_together_fulfil_the_task(env, name, seed):
    done, steps = rollout(env, seed, name)
    assert done
    assert steps < 700


def test_a_wrong_stack_is_taken_apart_and_built_anew(env):
    env.reset(seed=5, options={"prompt": "make a sandwich with ham"})
    x, y = PLATE_XY
    env.cell.place("onion", (x, y, 0.018))
    env.cell.place("bread", (x, y, 0.037))
    settle(env)
    command = env.task.next_command(env.state, env.brief, None)
    assert command == "pick up the bread"
    assert carry_on(env)


def test_a_wrong_thing_in_the_bin_is_taken_out(env):
    env.reset(seed=6, options={"prompt": "pack the ham and the tomato into the bin"})
    env.cell.place("toast", (BIN.x_m + 0.05, BIN.y_m, 0.04))
    settle(env)
    assert env.task.next_command(env.state, env.brief, None) == "pick up the toast"
    assert carry_on(env)


def test_an_object_that_slips_from_the_hand_is_fetched_again(env):
    env.reset(seed=7, options={"prompt": "make a sandwich with cheese"})
    while not env.state.holding or env.state.points[index("bread")][2] < 0.1:
        env.step(act(env.state, skills.parse("pick up the bread")))
    for _ in range(10):
        action = act(env.state, skills.parse(skills.PUT_ON_PLATE))
        action[[6, 13]] = 0.08
        env.step(action)
    assert carry_on(env)


def test_the_next_command_is_always_acceptable_and_any_order_packs(env):
    env.reset(seed=8, options={"prompt": "put the ham, the onion and the bread in the bin"})
    task, state, brief = env.task, env.state, env.brief
    picks = {"pick up the ham", "pick up the onion", "pick up the bread"}
    assert task.acceptable_commands(state, brief, None) == picks
    assert task.next_command(state, brief, None) == "pick up the ham"
    assert task.next_command(state, brief, "pick up the onion") == "pick up the onion"
    for previous in skills.COMMANDS:
        chosen = task.next_command(state, brief, previous)
        assert chosen in task.acceptable_commands(state, brief, previous)


def test_progress_grows_from_nothing_to_all(env):
    env.reset(seed=9, options={"task": "pack"})
    assert env.task.progress(env.state, env.brief) == 0.0
    assert carry_on(env)
    assert env.task.progress(env.state, env.brief) == 1.0
