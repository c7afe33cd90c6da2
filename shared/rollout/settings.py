"""Settings of a rollout."""

from typing import Annotated

from pydantic import Field

from shared.config import Settings


class RolloutSettings(Settings):
    """How the two rates mesh.

    control_hz: control steps per second of the robot (50 Hz: ALOHA).
    decision_steps: control steps between two queries of the high level (20 = 0.4 s).
    execute_steps: actions of a chunk that are executed before the low level is asked again.
    latency_steps: in lockstep, control steps between a query and its answer.
    history: previous commands that the high level is shown.
    max_steps: control steps after which an episode is a failure.
    supervised: in lockstep, stand still at each decision until a verdict comes.
    top: proposals that a decision carries.
    """

    control_hz: Annotated[float, Field(gt=0, le=1000)] = 50.0
    decision_steps: Annotated[int, Field(ge=1, le=1000)] = 20
    execute_steps: Annotated[int, Field(ge=1, le=100)] = 5
    latency_steps: Annotated[int, Field(ge=0, le=1000)] = 0
    history: Annotated[int, Field(ge=0, le=16)] = 4
    max_steps: Annotated[int, Field(ge=1, le=100_000)] = 900
    supervised: bool = False
    top: Annotated[int, Field(ge=1, le=64)] = 11
