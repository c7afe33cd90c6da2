"""How much is demonstrated, how long each arm trains, on how many scenes it is tried."""

from typing import Annotated, Literal, get_args

from pydantic import Field

from shared.config import Settings
from shared.policies.fitter import FitSettings

Arm = Literal["hierarchy", "chain", "latent", "flat", "guided"]
ARMS: tuple[Arm, ...] = get_args(Arm)
TITLES: dict[str, str] = {
    "hierarchy": "hierarchy",
    "oracle": "hierarchy, oracle above",
    "chain": "chain of thought",
    "latent": "latent goals",
    "flat": "flat",
    "guided": "latent goals, labels besides",
}
"""What is compared. Under the oracle the mover is the hierarchy's. Guided is a control: what mover,
soft pointer and rollout of latent goals can do, where their vector is a right command's."""

Count = Annotated[int, Field(ge=1)]


class DataSettings(Settings):
    """episodes: that the expert shows, in `parts` pieces. prompts: drawn without pictures.
    mistakes, slips: as in `Lesson`."""

    episodes: Count
    parts: Count = 16
    prompts: Count
    mistakes: float = 0.05
    slips: float = 0.002
    seed: Annotated[int, Field(ge=0, lt=90)] = 0


class BaselineSettings(Settings):
    """fit: one for all arms; its batch counts looks, its seed is the training seed's.
    rows: moments of an arm for each look. slice: updates from one word of progress to the next.
    seeds: of training. lengths: skills of the prompts. max_steps: as in `RolloutSettings`.
    """

    data: DataSettings
    fit: FitSettings
    rows: Count = 8
    slice: Count
    seeds: Count
    lengths: tuple[int, ...]
    max_steps: Count | None = None


SMALL = BaselineSettings(
    data=DataSettings(episodes=40, parts=8, prompts=200),
    fit=FitSettings(steps=150, batch=32),
    slice=75,
    seeds=1,
    lengths=(4, 8),
)
FULL = BaselineSettings(
    data=DataSettings(episodes=600, parts=30, prompts=6000),
    fit=FitSettings(steps=2500, batch=32),
    slice=1250,
    seeds=3,
    lengths=(4, 8, 12),
)
SCALES = {"small": SMALL, "core": FULL.model_copy(update={"seeds": 1}), "full": FULL}
