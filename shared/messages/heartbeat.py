"""Signs of life, told by the working loop itself: a stuck process keeps its liveliness token."""

from enum import StrEnum

from pydantic import Field

from shared.messages.goal import Goal
from shared.messages.help import Help
from shared.messages.message import Id, Message, Step, Text, TimeNs
from shared.messages.policy import Version


class RobotState(StrEnum):
    """What a robot is doing: working, standing still, or between two episodes.

    awaiting: until a verdict comes (supervised lockstep). asking: until somebody helps, for a
    while. paused: until somebody says resume.
    """

    ACTING = "acting"
    AWAITING = "awaiting"
    ASKING = "asking"
    PAUSED = "paused"
    IDLE = "idle"


class RobotHeartbeat(Message):
    """What a robot is doing now; newest wins.

    task, prompt, site, episode: None between two episodes.
    command: the goal in force; chosen_by as in `Decision`.
    supervised: it waits at each decision for a verdict.
    help: its call for help that is open.
    pending: records that its actor still keeps for the learner.
    pictures: the share of their rate that pictures get; less than 1 where its control loop needs
        the time.
    """

    robot: Id
    actor: Id
    time_ns: TimeNs
    state: RobotState
    task: Id | None = None
    prompt: Text | None = None
    site: Id | None = None
    episode: Id | None = None
    number: Step
    step: Step = 0
    command: Goal | None = None
    chosen_by: str = ""
    version: Version
    supervised: bool = False
    real_time: bool = True
    pending: Step = 0
    help: Help | None = None
    pictures: float = Field(default=1.0, ge=0, le=1)


class LearnerState(StrEnum):
    """What the learner is doing.

    judging: a candidate is tried in simulation, or runs on some robots first.
    """

    COLLECTING = "collecting"
    TRAINING = "training"
    JUDGING = "judging"
    STOPPED = "stopped"


class LearnerHeartbeat(Message):
    """What the learner has and does; newest wins.

    round: the last round that was begun, 0 before the first.
    episodes, successes, corrections: since the version in force was published.
    reason: why it stopped, when it did.
    """

    learner: Id
    time_ns: TimeNs
    state: LearnerState
    version: Version
    round: Step
    episodes: Step = 0
    successes: Step = 0
    corrections: Step = 0
    decisions: Step = 0
    reason: str = ""
    progress: float = Field(default=0.0, ge=0, le=1)
