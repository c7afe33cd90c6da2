"""Closed-loop examination of skills: how often they succeed, each rate with its interval."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from services.learner.pretrain.commander import ChainCommander, draw_stock
from shared.evaluation.hand import Hand
from shared.intervals import wilson
from shared.policies.checkpoint import Figure
from shared.policies.low_level import LowLevel
from shared.workcell import skills
from shared.workcell.env import WorkcellEnv
from shared.workcell.site import Site
from shared.workcell.skills import ATTEMPT_STEPS


class Tried(NamedTuple):
    """One thing tried: a skill's verb or a task's name, and whether it succeeded."""

    name: str
    success: bool
    steps: int


@dataclass(frozen=True)
class Exam:
    """What is to be tried.

    low_level: folder of its checkpoint. site: where. seeds: one episode each.
    phrases: for each command the sentences of which one is said; empty: the command itself.
    """

    low_level: Path
    site: Site | str
    seeds: tuple[int, ...]
    phrases: dict[str, tuple[str, ...]]


def try_skills(exam: Exam) -> list[Tried]:
    """Random chains of skills, each with one attempt within `ATTEMPT_STEPS`."""
    low, attempts = LowLevel.load(exam.low_level), []
    env = WorkcellEnv(exam.site, max_steps=10**9)
    for seed in exam.seeds:
        rng = np.random.default_rng(seed)
        env.reset(seed=seed)
        env.cell.reset(rng, draw_stock(rng))
        env.state = env.cell.state()
        hand, chain = Hand(low), ChainCommander(rng)
        for _ in range(8):
            skill = chain.draw(env.state)
            while skill.verb == "wait":
                skill = chain.draw(env.state)
            before, taken = env.state, 0
            said = exam.phrases.get(skill.text) or (skill.text,)
            hand.obey(str(rng.choice(said)))
            meaningful = skill.verb == "pick" or bool(before.holding)
            achieved = False
            while taken < ATTEMPT_STEPS and not achieved:
                env.step(hand.move(env))
                taken += 1
                achieved = skills.achieved(skill, before, env.state)
            if meaningful:
                attempts.append(Tried(skill.verb, achieved, taken))
    return attempts


def figure(name: str, outcomes: Iterable[bool]) -> Figure:
    """A rate with its interval."""
    outcomes = list(outcomes)
    low, high = wilson(sum(outcomes), len(outcomes))
    value = sum(outcomes) / max(1, len(outcomes))
    interval = (round(low, 4), round(high, 4))
    return Figure(name=name, value=round(value, 4), n=len(outcomes), interval=interval)


def by_name(attempts: Iterable[Tried], title: str) -> list[Figure]:
    """One figure for each name, in the order of the names, which goes into `title`'s braces."""
    attempts = list(attempts)
    return [
        figure(
            title.format(name), (attempt.success for attempt in attempts if attempt.name == name)
        )
        for name in sorted({attempt.name for attempt in attempts})
    ]
