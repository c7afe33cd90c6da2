"""How much practice, how many demonstrations, how long to train: two scales of the same recipe."""

from typing import Annotated

from pydantic import Field

from shared.config import Settings

Count = Annotated[int, Field(ge=0)]


class LowRound(Settings):
    """One turn of DAgger on the low level.

    practice: steps that the expert shows. updates: of the fit on all practice so far.
    filling: share of the chains of skills that fill one place.
    """

    practice: Count
    updates: Count
    lr: float = 1.5e-3
    filling: float = 0.0


class HighRound(Settings):
    """One turn of DAgger on the high level, all in the lab and with the task's oracle.

    driven: episodes in which the high level of the round before says what is done.
    updates: of the fit on all demonstrations so far.
    """

    driven: Count
    updates: Count
    lr: float = 1e-3


class Scale(Settings):
    """low: rounds of the low level; in the first the expert drives alone. phrases: drawn to
    teach its reader.

    expert_episodes, learned_episodes: demonstrations by the expert's hand and by the low level's;
    expert_mistakes, learned_mistakes: chance that a decision in them begins a wrong stretch.
    validation_episodes: more of the latter, never trained on.
    high: rounds of the high level; in the first nothing has been driven. high_batch: decisions in
    an update. prompts: how many are drawn for it without pictures. replay: decisions that
    are kept for the learner's rounds, at most.
    chains, tasks, trials: episodes that the skills, the oracle's tasks and the high level are
    examined in.
    """

    low: tuple[LowRound, ...]
    phrases: Count = 24_000
    expert_episodes: Count
    learned_episodes: Count
    expert_mistakes: float = 0.05
    learned_mistakes: float = 0.10
    validation_episodes: Count
    high: tuple[HighRound, ...]
    high_batch: Count
    prompts: Count
    replay: Count
    chains: Count
    tasks: Count
    trials: Count


SCALES = {
    "small": Scale(
        low=(
            LowRound(practice=6_000, updates=120),
            LowRound(practice=2_000, updates=60, filling=0.5),
        ),
        phrases=400,
        expert_episodes=8,
        learned_episodes=2,
        validation_episodes=2,
        high=(HighRound(driven=0, updates=60),),
        high_batch=48,
        prompts=200,
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
            LowRound(practice=240_000, updates=8_000, lr=1.8e-3, filling=0.6),
        ),
        expert_episodes=1_200,
        learned_episodes=1_000,
        validation_episodes=40,
        high=(HighRound(driven=0, updates=9_000), HighRound(driven=400, updates=4_000, lr=7e-4)),
        high_batch=96,
        prompts=6_000,
        replay=1_500,
        chains=60,
        tasks=120,
        trials=120,
    ),
}
