"""Whole hierarchies tried out in the cell: how often they succeed, and what an oracle would say.

Small on purpose: no bus, no services; the loop itself is measured with `shared/rollout`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from services.learner.pretrain.demonstrate import HISTORY
from services.learner.pretrain.exam import Attempt
from services.learner.pretrain.practice import DECISION_STEPS, EPISODE_STEPS
from shared.evaluation.hand import Hand
from shared.messages.observation import Observation
from shared.policies.examples import Examples
from shared.policies.high_level import HighLevel
from shared.policies.low_level import LowLevel
from shared.workcell.env import WorkcellEnv, objects, proprioception
from shared.workcell.site import Site


@dataclass(frozen=True)
class Trial:
    """What one process shall try.

    high_level, low_level: folders of checkpoints. site: where. seeds: one episode each.
    overrides: chance that the oracle's word is obeyed where the high level is wrong; 0 leaves
    the high level alone.
    """

    high_level: Path
    low_level: Path
    site: Site | str
    seeds: tuple[int, ...]
    overrides: float = 0.0


@dataclass(frozen=True, eq=False)
class Outcome:
    """attempts: one for each episode. examples: every decision with the oracle's label.
    wrong: decisions whose first choice was not acceptable."""

    attempts: list[Attempt]
    examples: Examples | None
    wrong: int
    decisions: int


def run(trial: Trial) -> Outcome:
    """Episode after episode in one process."""
    env = WorkcellEnv(trial.site)
    high, low = HighLevel.load(trial.high_level), LowLevel.load(trial.low_level)
    book = _Book()
    attempts = [_episode(env, seed, trial, high, low, book) for seed in trial.seeds]
    env.close()
    return Outcome(attempts, book.examples(), book.wrong, len(book.labels))


class _Book:
    """Decisions and what the oracle thought of them."""

    def __init__(self) -> None:
        self.seen: list[Observation] = []
        self.labels: list[str] = []
        self.wrong = 0

    def examples(self) -> Examples:
        return Examples(
            np.stack([seen.arrays["images"] for seen in self.seen]),
            [seen.prompt for seen in self.seen],
            [seen.previous for seen in self.seen],
            self.labels,
            np.ones(len(self.labels), np.float32),
        )


def _episode(
    env: WorkcellEnv, seed: int, trial: Trial, high: HighLevel, low: LowLevel, book: _Book
) -> Attempt:
    env.reset(seed=seed)
    hand, said = Hand(low), [""][:0]
    rng = np.random.default_rng([seed, 2])
    for step in range(EPISODE_STEPS):
        if step % DECISION_STEPS == 0:
            said.append(_decide(env, step, said, trial, high, book, rng))
            hand.obey(said[-1])
        if env.step(hand.move(env))[2]:
            return Attempt(env.brief.task, True, step + 1)
    return Attempt(env.brief.task, False, EPISODE_STEPS)


def _decide(
    env: WorkcellEnv,
    step: int,
    said: Sequence[str],
    trial: Trial,
    high: HighLevel,
    book: _Book,
    rng: np.random.Generator,
) -> str:
    seen = Observation(
        step=step,
        prompt=env.brief.prompt,
        previous=tuple(said[-HISTORY:]),
        arrays={
            "images": env.images(),
            "proprioception": proprioception(env.state),
            "objects": objects(env.state),
        },
    )
    chosen = high.propose(seen)[0].goal.text
    last = said[-1] if said else None
    fine = env.task.acceptable_commands(env.state, env.brief, last)
    label = chosen if chosen in fine else env.task.next_command(env.state, env.brief, last)
    book.seen.append(seen)
    book.labels.append(label)
    book.wrong += chosen not in fine
    return label if rng.random() < trial.overrides else chosen
