"""Scenes that the scripted expert prepares, so that a single skill or phrase can be tried there."""

from typing import Self

import numpy as np
from pydantic import model_validator

from shared.config import Settings
from shared.errors import WorkcellError, nearest
from shared.workcell import expert, skills
from shared.workcell.env import WorkcellEnv
from shared.workcell.objects import COUNT, OBJECT_NAMES
from shared.workcell.skills import COMMANDS
from shared.workcell.state import on_table
from shared.workcell.tasks import TASKS

CALL_STEPS = 300
"""The expert takes about 50 for a skill; a scene in which this doesn't suffice is none."""
LOOK_STEPS = 20
ANYTHING = "anything"
TRIES = 60
STRIDE = 1_000_003
"""From the seed of a scene that doesn't fit to the next one that is tried."""


class Setting(Settings):
    """Where something is tried.

    seed: of the scene. task: whose scene it is; "": any in which `fits` can be done.
    lead: so many skills of the task were done before.
    holding: the thing that a hand holds then, or "anything" from the table; "": none is picked up.
    fits: a command that must be possible there; where it isn't another seed is tried.
    """

    seed: int
    task: str = ""
    lead: int = 0
    holding: str = ""
    fits: str = ""

    @model_validator(mode="after")
    def _known(self) -> Self:
        for given, known in ((self.holding, (*OBJECT_NAMES, ANYTHING)), (self.fits, COMMANDS)):
            if given and given not in known:
                raise ValueError(f"{given!r} is unknown{nearest(given, known)}")
        return self


def prepare(env: WorkcellEnv, setting: Setting) -> str | None:
    """Make the scene; the command that was in force last, if there was one.

    Raises:
        WorkcellError: the cell knows no such task, or there is no such scene.
    """
    for number in range(TRIES if setting.fits else 1):
        try:
            said = _make(env, setting, number)
        except _NoSceneError:
            if not setting.fits:
                raise
            continue
        if not setting.fits or skills.possible(skills.parse(setting.fits), env.state):
            return said
    raise _NoSceneError(f"no scene from seed {setting.seed} on in which {setting.fits!r} can be")


class _NoSceneError(WorkcellError):
    """The expert can't make the scene."""


def _make(env: WorkcellEnv, setting: Setting, number: int) -> str | None:
    tasks = [setting.task] if setting.task else list(TASKS)
    task = tasks[(setting.seed + number) % len(tasks)]
    env.reset(seed=setting.seed + number * STRIDE, options={"task": task})
    said = _lead(env, setting.lead)
    if not setting.holding:
        return said
    thing = setting.holding if setting.holding != ANYTHING else _draw(env, setting.seed)
    return _hold(env, thing)


def _draw(env: WorkcellEnv, seed: int) -> str:
    """Something that lies on the table, drawn by the seed."""
    there = [row for row in range(COUNT) if on_table(env.state, row)]
    if not there:
        raise _NoSceneError("nothing is left on the table")
    return OBJECT_NAMES[int(np.random.default_rng(seed).choice(there))]


def _hold(env: WorkcellEnv, thing: str) -> str:
    """Pick it up."""
    said = skills.pick(OBJECT_NAMES.index(thing))
    skill, before = skills.parse(said), env.state
    if not skills.possible(skill, before):
        raise _NoSceneError(f"there is no {thing} in this scene")
    for _ in range(CALL_STEPS):
        if skills.achieved(skill, before, env.state):
            return said
        env.step(expert.act(env.state, skill))
    raise _NoSceneError(f"the {thing} can't be picked up in this scene")


def _lead(env: WorkcellEnv, calls: int) -> str | None:
    """Do the first skills of the task, up to the moment at which the next one would be said."""
    said: str | None = None
    done = 0
    for step in range(CALL_STEPS * calls):
        if step % LOOK_STEPS == 0:
            command = env.task.next_command(env.state, env.brief, said)
            done += said is not None and command != said
            if done == calls or command == skills.WAIT:
                break
            said = command
        assert said is not None  # The first step is a look.
        env.step(expert.act(env.state, skills.parse(said)))
    return said
