"""Scenes that the scripted expert prepares, so that a single skill or phrase can be tried there."""

from typing import Self

from pydantic import model_validator

from shared.config import Settings
from shared.errors import WorkcellError, nearest
from shared.workcell import expert, skills
from shared.workcell.env import WorkcellEnv
from shared.workcell.objects import OBJECT_NAMES

CALL_STEPS = 300
"""The expert takes about 50 for a skill; a scene in which this doesn't suffice is none."""
LOOK_STEPS = 20


class Setting(Settings):
    """Where something is tried.

    seed: of the scene. task: whose scene it is. lead: so many skills of the task were done before.
    holding: the thing that a hand holds then; "": none is picked up for it.
    """

    seed: int
    task: str
    lead: int = 0
    holding: str = ""

    @model_validator(mode="after")
    def _known(self) -> Self:
        if self.holding and self.holding not in OBJECT_NAMES:
            raise ValueError(f"no thing {self.holding!r}{nearest(self.holding, OBJECT_NAMES)}")
        return self


def prepare(env: WorkcellEnv, setting: Setting) -> str | None:
    """Make the scene; the command that was in force last, if there was one.

    Raises:
        WorkcellError: the cell knows no such task, or the expert can't make the scene.
    """
    env.reset(seed=setting.seed, options={"task": setting.task})
    said = _lead(env, setting.lead)
    if setting.holding:
        said = skills.pick(OBJECT_NAMES.index(setting.holding))
        skill, before = skills.parse(said), env.state
        for _ in range(CALL_STEPS):
            if skills.achieved(skill, before, env.state):
                return said
            env.step(expert.act(env.state, skill))
        raise WorkcellError(f"the {setting.holding} can't be picked up in scene {setting.seed}")
    return said


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
