"""How much practice, how many demonstrations, how long to train: two scales of the same recipe."""

from typing import Annotated

from pydantic import Field

from shared.config import Settings

Count = Annotated[int, Field(ge=0)]


class LowRound(Settings):
    """One turn of DAgger on the low level.

    practice: steps that the expert shows. updates: of the fit on all practice so far.
    """

    practice: Count
    updates: Count
    lr: float = 1.5e-3


class Scale(Settings):
    """low: rounds of the low level; in the first the expert drives alone. phrases: drawn to
    teach its reader.

    expert_episodes, learned_episodes: demonstrations by the expert's hand and by the low level's;
    expert_mistakes, learned_mistakes: chance that a decision in them begins a wrong stretch.
    validation_episodes: more of the latter, never trained on. high_updates, high_batch: of the
    high level's fit. replay: decisions that are kept for the learner's rounds.
    chains, tasks, trials: episodes that the skills, the oracle's tasks and the high level are
    examined in.
    """

    low: tuple[LowRound, ...]
    phrases: Count = 6_000
    expert_episodes: Count
    learned_episodes: Count
    expert_mistakes: float = 0.05
    learned_mistakes: float = 0.10
    validation_episodes: Count
    high_updates: Count
    high_batch: Count
    high_lr: float
    replay: Count
    chains: Count
    tasks: Count
    trials: Count


SCALES = {
    "small": Scale(
        low=(LowRound(practice=6_000, updates=120), LowRound(practice=2_000, updates=60)),
        phrases=400,
        expert_episodes=8,
        learned_episodes=2,
        validation_episodes=2,
        high_updates=60,
        high_batch=48,
        high_lr=1e-3,
        replay=64,
        chains=2,
        tasks=2,
        trials=2,
    ),
    "full": Scale(
        low=(
            LowRound(practice=240_000, updates=4_000, lr=2e-3),
            LowRound(practice=200_000, updates=5_000, lr=2e-3),
            LowRound(practice=200_000, updates=6_000, lr=1.8e-3),
        ),
        expert_episodes=400,
        learned_episodes=800,
        validation_episodes=40,
        high_updates=6_000,
        high_batch=96,
        high_lr=1e-3,
        replay=1_500,
        chains=60,
        tasks=120,
        trials=120,
    ),
}
