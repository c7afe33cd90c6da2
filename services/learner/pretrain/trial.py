"""Whole hierarchies tried out in the cell: how often they succeed, and what an oracle would say.

Small on purpose: no bus, no services; the loop itself is measured with `shared/rollout`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from services.learner.pretrain.demonstrate import HISTORY, LOOKS
from services.learner.pretrain.exam import Attempt, Hand
from services.learner.pretrain.practice import DECISION_STEPS
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
        self._first = 0

    def begin(self) -> None:
        """What comes now has no past."""
        self._first = len(self.seen)

    def past(self) -> list[NDArray[np.uint8]]:
        """The last earlier looks of this episode, oldest first."""
        return [seen.arrays["images"] for seen in self.seen[self._first :]][-LOOKS + 1 :]

    def examples(self) -> Examples:
        firsts = np.array([seen.step == 0 for seen in self.seen]).cumsum()
        looks = np.arange(len(self.seen))[:, None] + np.arange(-LOOKS + 1, 1)
        same = (looks >= 0) & (firsts[looks] == firsts[:, None])
        return Examples(
            np.stack([seen.arrays["images"] for seen in self.seen]),
            [seen.prompt for seen in self.seen],
            [seen.previous for seen in self.seen],
            self.labels,
            np.ones(len(self.labels), np.float32),
            np.stack([seen.arrays["proprioception"] for seen in self.seen]),
            np.where(same, looks, -1),
        )


def _episode(
    env: WorkcellEnv, seed: int, trial: Trial, high: HighLevel, low: LowLevel, book: _Book
) -> Attempt:
    env.reset(seed=seed)
    book.begin()
    hand, said = Hand(low), [""][:0]
    rng = np.random.default_rng([seed, 2])
    terminated = truncated = False
    while not (terminated or truncated):
        if env.elapsed_steps % DECISION_STEPS == 0:
            said.append(_decide(env, env.elapsed_steps, said, trial, high, book, rng))
            hand.obey(said[-1])
        _, _, terminated, truncated, _ = env.step(hand.move(env))
    return Attempt(env.brief.task, terminated, env.elapsed_steps)


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
    chosen = high.propose(seen, book.past())[0].goal.text
    last = said[-1] if said else None
    fine = env.task.acceptable_commands(env.state, env.brief, last)
    label = chosen if chosen in fine else env.task.next_command(env.state, env.brief, last)
    book.seen.append(seen)
    book.labels.append(label)
    book.wrong += chosen not in fine
    return label if rng.random() < trial.overrides else chosen
