"""Closed-loop examination: how often skills and tasks succeed, each rate with its interval."""

from collections.abc import Iterable
from dataclasses import dataclass
from math import sqrt
from pathlib import Path
from typing import NamedTuple

import numpy as np

from services.learner.pretrain.commander import ChainCommander, TaskCommander, draw_stock
from services.learner.pretrain.practice import DECISION_STEPS, EPISODE_STEPS, EXECUTE_STEPS
from shared.messages.goal import LanguageGoal
from shared.policies.checkpoint import Figure
from shared.policies.low_level import LowLevel
from shared.workcell import skills
from shared.workcell.env import WorkcellEnv, objects, proprioception
from shared.workcell.site import Site

ATTEMPT_STEPS = 120


class Attempt(NamedTuple):
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


def try_tasks(exam: Exam) -> list[Attempt]:
    """Tasks with the oracle as the high level."""
    low, attempts = LowLevel.load(exam.low_level), []
    env = WorkcellEnv(exam.site)
    for seed in exam.seeds:
        env.reset(seed=seed)
        commander = TaskCommander(env.brief, env.task, np.random.default_rng(seed), slips=0.0)
        hand = Hand(low)
        for step in range(EPISODE_STEPS):
            if step % DECISION_STEPS == 0:
                hand.obey(commander.command(env.state) or skills.WAIT)
            if env.step(hand.move(env))[2]:
                break
        attempts.append(Attempt(env.brief.task, env.elapsed_steps < EPISODE_STEPS, step + 1))
    return attempts


def try_skills(exam: Exam) -> list[Attempt]:
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
            while taken < ATTEMPT_STEPS and not skills.achieved(skill, before, env.state):
                env.step(hand.move(env))
                taken += 1
            if meaningful:
                attempts.append(Attempt(skill.verb, taken < ATTEMPT_STEPS, taken))
    return attempts


class Hand:
    """The low level with its running chunk, as in the rollout."""

    def __init__(self, low_level: LowLevel) -> None:
        self._low_level = low_level
        self._said = ""
        self._chunk: list[np.ndarray] = []

    def obey(self, command: str) -> None:
        """Another command cuts the chunk."""
        if command != self._said:
            self._said, self._chunk = command, []

    def move(self, env: WorkcellEnv) -> np.ndarray:
        """The next action, [14]."""
        if not self._chunk:
            senses = proprioception(env.state), objects(env.state)
            chunk = self._low_level.act(*senses, LanguageGoal(text=self._said))
            self._chunk = list(chunk[:EXECUTE_STEPS])
        return self._chunk.pop(0)


def figure(name: str, outcomes: Iterable[bool]) -> Figure:
    """A rate with its interval."""
    outcomes = list(outcomes)
    low, high = wilson(sum(outcomes), len(outcomes))
    value = sum(outcomes) / max(1, len(outcomes))
    return Figure(name=name, value=round(value, 4), n=len(outcomes), interval=(low, high))


def wilson(successes: int, n: int, z: float = 1.96) -> tuple[float, float]:
    """95 % interval of a rate. Source: Wilson 1927, JASA 22."""
    if n == 0:
        return (0.0, 1.0)
    rate, weight = successes / n, z * z / n
    middle = (rate + weight / 2) / (1 + weight)
    half = z * sqrt(rate * (1 - rate) / n + weight / (4 * n)) / (1 + weight)
    return (round(max(0.0, middle - half), 4), round(min(1.0, middle + half), 4))


def by_name(attempts: Iterable[Attempt], title: str) -> list[Figure]:
    """One figure for each name, in the order of the names, which goes into `title`'s braces."""
    attempts = list(attempts)
    return [
        figure(
            title.format(name), (attempt.success for attempt in attempts if attempt.name == name)
        )
        for name in sorted({attempt.name for attempt in attempts})
    ]
