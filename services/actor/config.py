"""Settings of an actor process."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from shared.config import Settings
from shared.messages.message import Id
from shared.rollout.settings import Replan, RolloutSettings
from shared.wire.bus import BusSettings
from shared.workcell.tasks import TASKS


class Pace(StrEnum):
    """Real time: 50 Hz by the wall clock. Lockstep: as fast as the machine, counted in steps."""

    REAL_TIME = "real-time"
    LOCKSTEP = "lockstep"


class Refresh(StrEnum):
    """When a new version is taken up: between two episodes, or between two decisions."""

    EPISODE = "episode"
    DECISION = "decision"


class FrameSettings(Settings):
    """Pictures for people; rendered only while somebody watches.

    rate_hz: of the robot that somebody looks at; slow_hz: of those that are only in view beside it.
    """

    rate_hz: Annotated[float, Field(gt=0, le=60)] = 8.0
    slow_hz: Annotated[float, Field(gt=0, le=60)] = 2.0
    width: Annotated[int, Field(ge=64, le=1280)] = 400
    height: Annotated[int, Field(ge=64, le=1280)] = 300
    quality: Annotated[int, Field(ge=10, le=100)] = 85


class HelpSettings(Settings):
    """When a robot calls for help; as it is here, never.

    measure: what doubt is reckoned from: the entropy of the scores, or the margin of the best two.
    threshold: the doubt, up to 1, from which on it calls; None: never out of doubt.
    calm: share of the threshold below which it is sure again, and takes its call back.
    stuck_steps: control steps of one command of which nothing comes, or of a circle of two, after
        which it calls; 0: never.
    pause_steps: control steps from the end of one call to the next one at the soonest.
    wait_s: how long it stands still until somebody answers, at most; 0: it goes on at once.
    per_hour: calls of one robot within any hour, over restarts, too; 0: no limit.
    """

    measure: Literal["entropy", "margin"] = "entropy"
    threshold: Annotated[float, Field(gt=0, le=1)] | None = None
    calm: Annotated[float, Field(ge=0, le=1)] = 0.8
    stuck_steps: Annotated[int, Field(ge=0, le=100_000)] = 0
    pause_steps: Annotated[int, Field(ge=0, le=100_000)] = 100
    wait_s: Annotated[float, Field(ge=0, le=3600)] = 0.0
    per_hour: Annotated[int, Field(ge=0, le=3600)] = 60


class ActorSettings(Settings):
    """One process with one or many robots.

    mode: robots; or evaluation, in which it has none and rolls out what the learner's gate wants
        compared, by the gate's settings.
    robots: their ids on the wire. kind: the entry point of group `hl_dagger.robots` that makes
        them. first_index: number of the first robot in the fleet, from which its seeds follow.
    tasks: taken in turn. site: the settings file of the cell. skills: how many each prompt that a
        robot draws takes; None: as its task likes, and what a robot of another kind is not asked.
    episodes_per_version: after so many episodes a robot waits for a newer version; 0: never.
    wait_for_version_s: it waits that long at most, then does another share with the version it has
        (the gate may have refused a candidate); 0: for ever.
    verdict_timeout_s: in supervised lockstep, go on without a verdict after this; 0: never.
    wait_for_policy_s: at start, how long to wait for the learner before running what is on disk.
    nice: how much an actor in evaluation mode yields to robots on the same machine.
    low_level, high_level: checkpoint folders; None: the ones that come with the package.
    data: folder of the outbox and of the last version that was taken up.
    """

    id: Id = "actor-1"
    mode: Literal["robots", "evaluation"] = "robots"
    robots: Annotated[tuple[Id, ...], Field(min_length=1)] = ("robot-1",)
    kind: str = "workcell"
    first_index: Annotated[int, Field(ge=0, le=999)] = 0
    tasks: Annotated[tuple[Id, ...], Field(min_length=1)] = tuple(TASKS)
    site: str = "far"
    skills: Annotated[int, Field(ge=1, le=64)] | None = None
    pace: Pace = Pace.REAL_TIME
    refresh: Refresh = Refresh.EPISODE
    rollout: RolloutSettings = RolloutSettings()
    help: HelpSettings = HelpSettings()
    frames: FrameSettings = FrameSettings()
    bus: BusSettings = BusSettings()
    seed: Annotated[int, Field(ge=0, le=10_000)] = 0
    episodes_per_version: Annotated[int, Field(ge=0)] = 0
    wait_for_version_s: Annotated[float, Field(ge=0)] = 600.0
    rest_s: Annotated[float, Field(ge=0, le=3600)] = 1.0
    verdict_timeout_s: Annotated[float, Field(ge=0)] = 0.0
    wait_for_policy_s: Annotated[float, Field(ge=0)] = 10.0
    low_level: Path | None = None
    high_level: Path | None = None
    data: Path = Path("runs/actor-1")
    threads: Annotated[int, Field(ge=1, le=64)] = 1
    nice: Annotated[int, Field(ge=0, le=19)] = 0
    log_level: str = "info"

    @property
    def hierarchy(self) -> RolloutSettings:
        """`rollout` as a robot runs it.

        Where only completion makes π_HL look, a robot that is to call when it is stuck gets a stuck
        timer: without a look nobody would find out.
        """
        rollout, stuck_steps = self.rollout, self.help.stuck_steps
        if stuck_steps and rollout.replan is Replan.COMPLETION and not rollout.patience_steps:
            return rollout.model_copy(update={"stuck_steps": stuck_steps})
        return rollout
