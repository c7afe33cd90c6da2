"""Scenes in which a skill makes sense, drawn by the seed."""

import numpy as np

from services.learner.experiments.bench import Bench
from shared.evaluation.scene import ANYTHING, Setting
from shared.workcell.skills import PUTS, SKILLS, WAIT, Skill

LEADS = (0, 2, 4)
"""Skills of the task that were done before a put, so that there is something there already."""


def setting_for(skill: Skill, bench: Bench, number: int, held: str = ANYTHING) -> Setting:
    """The bench's `number`-th scene for this skill: for a put, a hand holds something, or that."""
    seed = bench.seed(number)
    chance = np.random.default_rng([seed, SKILLS.index(skill)])
    lead, holding = 0, ""
    if skill.text in PUTS or (skill.text == WAIT and chance.random() < 0.5):
        lead, holding = int(chance.choice(LEADS)), held
    return Setting(seed=seed, lead=lead, holding=holding, fits=skill.text)
