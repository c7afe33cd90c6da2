"""The cell as a gymnasium environment."""

import hashlib
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from shared.workcell.env import WorkcellEnv
from shared.workcell.errors import InvalidAction
from shared.workcell.expert import act
from shared.workcell.skills import parse

ROOT = Path(__file__).parents[3]


def digest(env: WorkcellEnv, seed: int) -> str:
    """Hash of sixty steps of states and of a picture."""
    env.reset(seed=seed)
    total = hashlib.sha256()
    for _ in range(60):
        env.step(act(env.state, parse("pick up the ham")))
        for array in env.state.to_arrays().values():
            total.update(array.tobytes())
    total.update(env.images().tobytes())
    return total.hexdigest()


@pytest.mark.filterwarnings("ignore::UserWarning")  # it would have actions scaled to [-1, 1]
def test_gymnasium_finds_no_fault():
    env = WorkcellEnv("lab", cameras=True, render_mode="rgb_array")
    check_env(env, skip_render_check=True)
    env.close()


def test_equal_seeds_give_equal_episodes_to_the_bit(env):
    first = digest(env, 3)
    assert digest(env, 4) != first
    assert digest(env, 3) == first


def test_another_process_lives_the_same_episode():
    code = (
        "from tests.unit.workcell.test_env import digest, WorkcellEnv;"
        "print(digest(WorkcellEnv('far'), 3))"
    )
    run = [sys.executable, "-c", code]
    other = subprocess.run(run, capture_output=True, text=True, check=True, cwd=ROOT)
    far = WorkcellEnv("far")
    assert other.stdout.strip() == digest(far, 3)
    far.close()


def test_a_prompt_given_is_the_prompt_obeyed(env):
    _, info = env.reset(seed=0, options={"prompt": "pack the ham and the toast into the bin"})
    assert info == {
        "prompt": "pack the ham and the toast into the bin",
        "task": "pack",
        "success": False,
        "elapsed_steps": 0,
        "disturbed": 0,
    }


def test_an_action_that_is_no_action_is_refused(env):
    env.reset(seed=0)
    with pytest.raises(InvalidAction, match="14 finite"):
        env.step(np.full(14, np.nan))
    with pytest.raises(InvalidAction, match="14 finite"):
        env.step(np.zeros(7))


def test_an_episode_is_cut_off_after_its_steps():
    env = WorkcellEnv("lab", max_steps=3)
    env.reset(seed=0)
    ends = [env.step(act(env.state, parse("wait")))[2:4] for _ in range(3)]
    assert ends == [(False, False), (False, False), (False, True)]


def test_two_cells_in_one_process_draw_their_own_pictures(env):
    other = WorkcellEnv("far")
    env.reset(seed=1)
    other.reset(seed=1)
    lab, far, again = env.images(), other.images(), env.images()
    other.close()
    assert lab.shape == (2, 64, 64, 3)
    assert lab.tobytes() == again.tobytes()
    assert np.abs(lab.astype(float) - far).mean() > 20


def test_a_picture_for_people_has_the_size_asked_for(env):
    env.reset(seed=1)
    picture = env.picture("angle", width=320, height=200)
    assert picture.shape == (200, 320, 3)
    assert picture.std() > 20
