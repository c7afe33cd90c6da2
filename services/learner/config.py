"""Settings of the learner; defaults < TOML < HLD_LEARNER_… < --set."""

import math
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from services.learner.gate import GateSettings
from services.learner.labels.aggregate import LabelSettings
from services.learner.labels.balance import BalanceSettings
from services.learner.rounds import RoundSettings
from shared.config import Settings
from shared.messages.message import Id
from shared.wire.bus import BusSettings


class TrainSettings(Settings):
    """How a round trains.

    start: from the version in force, or anew from the first one of the store.
    steps: updates at least. epochs: how often each label is drawn on average, if that takes more
        updates. max_steps: but no more than these.
    batch, lr, frozen_encoder, mind_rate, retoned: as in `shared.policies.fitter.FitSettings`.
    correction_share: of each batch, from what people said in all rounds so far; the rest are
        demonstrations.
    own_weights: share of what a round learned in its weights; the rest is the first version's,
        so that what that knew is kept (`anchor.py`); 1: all.
    threads: of torch; by another number the weights differ in their last bits. nice: how much the
        training yields to robots on the same machine.
    """

    start: Literal["in-force", "base"] = "in-force"
    steps: Annotated[int, Field(ge=1, le=1_000_000)] = 200
    epochs: Annotated[float, Field(ge=0, le=1000)] = 5.0
    max_steps: Annotated[int, Field(ge=1, le=1_000_000)] = 4000
    batch: Annotated[int, Field(ge=2, le=4096)] = 64
    lr: Annotated[float, Field(gt=0, le=1)] = 1e-3
    frozen_encoder: bool = False
    mind_rate: Annotated[float, Field(gt=0, le=1)] = 0.1
    retoned: Annotated[float, Field(ge=0, le=1)] = 0.5
    correction_share: Annotated[float, Field(gt=0, lt=1)] = 0.5
    own_weights: Annotated[float, Field(gt=0, le=1)] = 0.8
    threads: Annotated[int, Field(ge=1)] = 2
    nice: Annotated[int, Field(ge=0, le=19)] = 5

    def updates(self, labels: int) -> int:
        """How many a round with so many labels makes."""
        drawn = self.batch * self.correction_share  # In one update.
        wanted = math.ceil(self.epochs * labels / drawn)
        return max(self.steps, min(wanted, self.max_steps))


class Recipe(Settings):
    """Everything that decides what a round makes of what happened; kept in its manifest."""

    labels: LabelSettings = LabelSettings()
    balance: BalanceSettings = BalanceSettings()
    train: TrainSettings = TrainSettings()
    gate: GateSettings = GateSettings()


class LearnerSettings(Settings):
    """The learner.

    data: folder of the run; all that the learner keeps lies in it.
    seed: of the training, to which each round adds its number.
    store: URL of the database; empty means SQLite in `data`.
    low_level, high_level, demonstrations: checkpoint folders; None takes those that come with
        the project. The high level is only what a fresh store starts from.
    log_level: debug, info, warning or error.
    """

    id: Id = "learner"
    data: Path = Path("runs/learner")
    seed: Annotated[int, Field(ge=0)] = 0
    store: str = ""
    low_level: Path | None = None
    high_level: Path | None = None
    demonstrations: Path | None = None
    log_level: Literal["debug", "info", "warning", "error"] = "info"
    bus: BusSettings = BusSettings()
    round: RoundSettings = RoundSettings()
    labels: LabelSettings = LabelSettings()
    balance: BalanceSettings = BalanceSettings()
    train: TrainSettings = TrainSettings()
    gate: GateSettings = GateSettings()

    @model_validator(mode="after")
    def _can_judge(self) -> Self:
        gate = self.gate
        if not gate.held_out_share and not gate.trials.episodes and gate.unjudged == "refuse":
            raise ValueError(
                "gate.held_out_share=0 leaves nothing to judge a candidate by, so that none would "
                "go out: set gate.unjudged=let-out as well, or gate.trials.episodes"
            )
        return self

    def recipe(self) -> Recipe:
        """The part that a round's result depends on."""
        return Recipe(labels=self.labels, balance=self.balance, train=self.train, gate=self.gate)
