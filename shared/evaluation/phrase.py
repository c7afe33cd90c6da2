"""One phrase put to the low level in one scene: what it understood, and what it did."""

import json
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from pydantic import BaseModel, ConfigDict

from shared.code import sha256_code
from shared.config import Settings
from shared.evaluation.hand import Hand
from shared.evaluation.scene import Setting, prepare
from shared.messages.goal import Goal
from shared.policies.checkpoint import bundled, load_card
from shared.policies.low_level import LowLevel
from shared.workcell import skills
from shared.workcell.env import WorkcellEnv, objects, proprioception
from shared.workcell.objects import COUNT
from shared.workcell.site import load_site
from shared.workcell.skills import ATTEMPT_STEPS, PUTS, SKILLS, WAIT
from shared.workcell.state import CellState, on_table

READING = ("shared/policies/low_level.py", "shared/policies/reader/*.py", "shared/goals/**/*.py")
"""Files that decide what a phrase is taken for."""


class Near(NamedTuple):
    """A known command and how near a phrase is to it; 1 is the same."""

    command: str
    score: float


class Reading(NamedTuple):
    """What was understood. refused: why nothing will be done; "" if something is.

    nearest: known commands, best first; the first is the one that is obeyed.
    """

    refused: str
    nearest: tuple[Near, ...]


class Phrases(Settings):
    """Who is spoken to: a low level (a checkpoint folder; "": the bundled one) at a site."""

    site: str = "lab"
    low_level: str = ""

    def folder(self) -> Path:
        """Where the low level lies."""
        return Path(self.low_level) if self.low_level else bundled("low_level")

    def note(self) -> str:
        """What its rows hang on; see `Plan.note`. Here also the rules by which phrases are read,
        which no checkpoint holds."""
        told = {
            "site": load_site(self.site).model_dump(mode="json"),
            "low_level": load_card(self.folder()).tensors_sha256,
            "reads": sha256_code(READING),
        }
        return json.dumps(told)


class Trial(Settings):
    """What is said and where.

    phrase: what is said; "": a command that contradicts what would be right, drawn by the seed.
    expected: the command that it should be taken for; "": the one that it is.
    steps: how long it has.
    """

    setting: Setting
    phrase: str = ""
    expected: str = ""
    steps: int = ATTEMPT_STEPS


class Said(BaseModel):
    """What came of a trial.

    phrase: as it was said. obvious: what would have been right to say.
    achieved: the last command that was achieved; None if none was. done: all, in order.
    already: what was expected was so before anything was said.
    steps: until what was expected was achieved, else all that there were.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    trial: Trial
    phrase: str
    refused: str
    nearest: tuple[Near, ...]
    obvious: str
    expected: str
    achieved: str | None
    already: bool
    done: tuple[str, ...]
    steps: int

    @property
    def success(self) -> bool:
        """What was expected was achieved."""
        return self.achieved == self.expected


class Speaker:
    """One process's low level and cell, spoken to in one scene after another."""

    def __init__(self, plan: Phrases) -> None:
        torch.set_num_threads(1)  # The processes share the cores.
        self._low_level = LowLevel.load(plan.folder())
        self._env = WorkcellEnv(plan.site, max_steps=1 << 30)

    def __call__(self, trial: Trial) -> Said:
        """Prepare the scene, say the phrase, see what happens."""
        env = self._env
        previous = prepare(env, trial.setting)
        obvious = env.task.next_command(env.state, env.brief, previous)
        fine = env.task.acceptable_commands(env.state, env.brief, previous)
        phrase = trial.phrase or contrary(env.state, fine, trial.setting.seed)
        reading = self.read(phrase)
        meant = self._low_level.meaning(Goal(text=phrase), objects(env.state))
        expected = trial.expected or meant or reading.nearest[0].command
        already = expected != WAIT and skills.achieved(skills.parse(expected), env.state, env.state)
        done, steps = ((), 0) if reading.refused else self._act(phrase, expected, trial.steps)
        return Said(
            trial=trial,
            phrase=phrase,
            refused=reading.refused,
            nearest=reading.nearest,
            obvious=obvious,
            expected=expected,
            achieved=done[-1] if done else None,
            already=already,
            done=done,
            steps=steps,
        )

    def read(self, phrase: str) -> Reading:
        """What the low level makes of a phrase in the scene as it is."""
        senses = proprioception(self._env.state), objects(self._env.state)
        refused = self._low_level.objection(*senses, Goal(text=phrase))
        near = self._low_level.nearest(*senses, Goal(text=phrase))
        return Reading(refused, tuple(Near(text, round(score, 4)) for text, score in near))

    def _act(self, phrase: str, expected: str, steps: int) -> tuple[tuple[str, ...], int]:
        """The commands that were achieved, in order, and the steps that it took."""
        env, hand = self._env, Hand(self._low_level)
        before, done = env.state, [""][:0]
        # What is held already needn't be picked up: to wait with it is to wait.
        undone = [
            skill
            for skill in SKILLS
            if skill.text != WAIT and not skills.achieved(skill, before, before)
        ]
        hand.obey(phrase)
        for step in range(1, steps + 1):
            env.step(hand.move(env))
            for skill in undone:
                if skill.text in done:
                    continue
                if skills.achieved(skill, before, env.state):
                    done.append(skill.text)
            if expected in done:
                return tuple(done), step
        still = env.state.holding == before.holding and not done
        return ((WAIT,) if still and expected == WAIT else tuple(done)), steps

    def close(self) -> None:
        """Give the cell back."""
        self._env.close()


def contrary(state: CellState, fine: frozenset[str], seed: int) -> str:
    """A command that can be obeyed here and contradicts all that are right, drawn by the seed."""
    if state.holding:
        choices = sorted(text for text in PUTS - fine if skills.possible(skills.parse(text), state))
    else:
        items = [row for row in range(COUNT) if on_table(state, row)]
        choices = [text for text in map(skills.pick, items) if text not in fine]
    return str(np.random.default_rng(seed).choice(choices or [WAIT]))
