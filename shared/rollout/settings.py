"""Settings of a rollout."""

from enum import StrEnum
from typing import Annotated, Literal

from pydantic import Field

from shared.config import Settings


class Replan(StrEnum):
    """When the high level is asked again, besides at once after an interjection.

    interval: every `decision_steps`. completion: when the low level's classifier says that the
    command is achieved. both: by interval, by completion, and by a stuck timer.
    """

    INTERVAL = "interval"
    COMPLETION = "completion"
    BOTH = "both"


class RolloutSettings(Settings):
    """How the two rates mesh.

    control_hz: control steps per second of the robot (50 Hz: ALOHA).
    replan: when the high level is asked again.
    decision_steps: control steps between two queries of the high level (20 = 0.4 s); by completion,
        between two queries about a command that stays achieved.
    completion_threshold: the probability from which on a command counts as achieved.
    completion_check_steps: control steps at least between two looks at the classifier, which is
        asked only where a chunk is fetched.
    stuck_steps: control steps of one command without completion, after which the high level is
        asked whatever the classifier says; 0: never. None: 150 where `replan` is both, else never.
    hysteresis: how much more probable than the command in force another one must be to replace it.
    smoothing: weight of the earlier looks in the running mean of the scores (0.5: about three
        looks, as SRT-H); 0: every look stands for itself.
    dwell_steps: control steps that a command stays in force before the high level may change it.
    execute_steps: actions of a chunk that are executed before the low level is asked again.
    latency_steps: in lockstep, control steps between a query and its answer.
    history: previous commands that the high level is shown.
    looks: observations that the high level is shown, the present one and earlier ones.
    look_every: decisions from one look to the next.
    max_steps: control steps after which an episode is a failure; None: as the scene deserves.
    supervised: in lockstep, stand still at each decision until a verdict comes.
    top: proposals that a decision carries.
    head: what of the high level answers: "bank" scores the phrases that it knows, "text" makes
        phrases word by word.
    """

    control_hz: Annotated[float, Field(gt=0, le=1000)] = 50.0
    replan: Replan = Replan.INTERVAL
    decision_steps: Annotated[int, Field(ge=1, le=1000)] = 20
    completion_threshold: Annotated[float, Field(gt=0, le=1)] = 0.5
    completion_check_steps: Annotated[int, Field(ge=1, le=1000)] = 5
    stuck_steps: Annotated[int, Field(ge=0, le=100_000)] | None = None
    hysteresis: Annotated[float, Field(ge=0, le=1)] = 0.0
    smoothing: Annotated[float, Field(ge=0, lt=1)] = 0.0
    dwell_steps: Annotated[int, Field(ge=0, le=10_000)] = 0
    execute_steps: Annotated[int, Field(ge=1, le=100)] = 5
    latency_steps: Annotated[int, Field(ge=0, le=1000)] = 0
    history: Annotated[int, Field(ge=0, le=16)] = 4
    looks: Annotated[int, Field(ge=1, le=16)] = 4
    look_every: Annotated[int, Field(ge=1, le=100)] = 1
    max_steps: Annotated[int, Field(ge=1, le=100_000)] | None = None
    supervised: bool = False
    top: Annotated[int, Field(ge=1, le=64)] = 11
    head: Literal["bank", "text"] = "bank"

    @property
    def patience_steps(self) -> int:
        """`stuck_steps` as it applies; 0: no stuck timer."""
        if self.stuck_steps is not None:
            return self.stuck_steps
        return 150 if self.replan is Replan.BOTH else 0
