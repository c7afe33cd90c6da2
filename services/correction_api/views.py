"""What people and programs read over HTTP; messages go out under their own names and fields."""

from enum import StrEnum
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from services.correction_api.store.log import Entry, Later, Status
from shared.messages.correction import Correction, Kind
from shared.messages.decision import Proposal
from shared.messages.episode import Episode
from shared.messages.goal import Goal
from shared.messages.heartbeat import LearnerState, RobotState
from shared.messages.help import Reason
from shared.messages.message import Id, TimeNs
from shared.messages.observation import CAMERAS
from shared.messages.policy import Version
from shared.messages.receipt import Receipt


class View(BaseModel):
    """Base of what is shown."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class Presence(StrEnum):
    """How fresh the last sign of life is; `unseen` means that there never was one."""

    ONLINE = "online"
    STALE = "stale"
    OFFLINE = "offline"
    UNSEEN = "unseen"


class DecisionBrief(View):
    """The newest decision, as far as a person needs it to correct it."""

    id: Annotated[str, Field(examples=["ep-5f1c-3"])]
    index: int
    step: int
    proposed: tuple[Proposal, ...]
    awaits_verdict: bool


class CourseView(View):
    """A command that came in force. step: about when, since it may be heard of a little later."""

    step: int
    text: str
    by: Annotated[str, Field(pattern="^(policy|person)$", examples=["policy"])]


class RobotView(View):
    """One robot now.

    presence: by the age of its last heartbeat, age_s. state: what it said it was doing.
    task, prompt, site, episode: null between two episodes.
    course: the commands of this episode so far, oldest first; the last one is in force.
    command: the one in force; by: the policy or a person; chosen_by: the policy version, or the
        id of that person's correction; author: who it was, if that is still known.
    pending: records that its actor still keeps for the learner.
    pictures: the share of their rate that pictures get while its control loop needs the time.
    """

    robot: Annotated[Id, Field(examples=["robot-1"])]
    actor: Annotated[Id, Field(examples=["actor-1"])]
    presence: Presence
    age_s: Annotated[float, Field(examples=[0.2])]
    state: RobotState
    task: Annotated[str | None, Field(examples=["sandwich"])]
    prompt: Annotated[str | None, Field(examples=["make a sandwich with cheese and tomato"])]
    site: Annotated[str | None, Field(examples=["far"])]
    episode: Annotated[Id | None, Field(examples=["ep-5f1c"])]
    number: int
    step: int
    command: Goal | None
    by: Annotated[str | None, Field(pattern="^(policy|person)$", examples=["policy"])]
    chosen_by: Annotated[str | None, Field(examples=["1.0"])]
    author: Annotated[str | None, Field(examples=[None])]
    course: tuple[CourseView, ...] = ()
    decision: DecisionBrief | None
    version: Version
    supervised: bool
    real_time: bool
    pending: int
    pictures: float
    cameras: tuple[str, ...] = CAMERAS


class HelpView(View):
    """A robot that asks for help.

    decision, step: where it began to ask; since_ns: when, by the clock of its actor.
    reason: entropy or margin of the scores, or stuck: nothing comes of its command.
    doubt: 0 to 1, now. waits_s: how much longer it stands still for an answer; 0: it goes on.
    proposed: the first few of its newest decision, best first.
    """

    robot: Annotated[Id, Field(examples=["robot-1"])]
    episode: Annotated[Id, Field(examples=["ep-5f1c"])]
    decision: Annotated[Id, Field(examples=["ep-5f1c-3"])]
    step: int
    since_ns: TimeNs
    reason: Reason
    doubt: Annotated[float, Field(examples=[0.62])]
    waits_s: Annotated[float, Field(examples=[12.5])]
    prompt: str
    command: Goal
    proposed: tuple[Proposal, ...]


class HelpQueue(View):
    """Who asks for help: who stands still first, then by doubt.

    suppressed: how many more do, beyond the budget of the fleet.
    """

    asking: list[HelpView]
    suppressed: int


class Phrase(View):
    """Whether the low level knows a command, word for word; one that is new may be obeyed, too.

    nearest: the commands that it knows and that are spelt most alike.
    """

    known: bool
    nearest: tuple[str, ...] = ()


class ReplacedView(View):
    """The correction that ended an earlier one: an override, a release or a retract.

    author: who said it. step: the first control step at which the earlier one no longer held.
    """

    correction: Annotated[Id, Field(examples=["say-1b2c3d4e5f60710a"])]
    author: Annotated[Id, Field(examples=["ben"])]
    kind: Kind
    step: Annotated[int, Field(examples=[93])]

    @classmethod
    def of(cls, later: Later) -> "ReplacedView":
        """What is shown of the later one."""
        said = later.correction
        return cls(correction=said.id, author=said.author, kind=said.kind, step=later.step)


class CorrectionView(View):
    """A correction, what became of it, and where it stands in the log.

    status: `expired` means that no robot answered in time, `kept` that none had to, since it is
        about the past. reason: why it is not in force.
    replaced_by: it took force, and then the word of this one held instead.
    learned_in: the first version that was trained with it; a rollback doesn't change that.
    held_out: it is kept aside, to judge versions by.
    """

    correction: Correction
    status: Status
    receipt: Receipt | None = None
    reason: str = ""
    replaced_by: ReplacedView | None = None
    sequence: int
    phrase: Phrase | None = None
    learned_in: Annotated[Version | None, Field(examples=["1.1"])] = None
    held_out: bool = False

    @classmethod
    def of(cls, entry: Entry, phrase: Phrase | None = None) -> "CorrectionView":
        """What is shown of a log entry."""
        return cls(
            correction=entry.correction,
            status=entry.status,
            receipt=entry.receipt,
            reason=entry.reason,
            replaced_by=ReplacedView.of(entry.later) if entry.later else None,
            sequence=entry.sequence,
            phrase=phrase,
            learned_in=entry.learned_in,
            held_out=entry.held_out,
        )


class PersonView(View):
    """Somebody whose page is open, and the robots that they have in focus."""

    name: Id
    robots: list[Id]


class PeopleView(View):
    """Who is here, by name."""

    here: list[PersonView]


class Robots(View):
    """The robots that ever gave a sign of life, by name."""

    robots: list[RobotView]


class CorrectionPage(View):
    """Corrections, the newest first; `next` is the cursor of the page after this one."""

    corrections: list[CorrectionView]
    next: Annotated[str | None, Field(examples=[None])] = None


class TallyView(View):
    """How often a policy version succeeded; episodes that were broken off don't count."""

    version: Version
    episodes: int
    successes: int
    corrections: int


class EpisodeView(Episode):
    """An episode that is over, and what was counted here of it.

    calls: how often its robot asked for help. taught: how many things were said of it that tell
        what would be right, while it ran or afterwards.
    """

    calls: int = 0
    taught: int = 0


class EpisodePage(View):
    """Episodes, the newest first, and the success of each version over all that are known.

    tasks: of all that are known.
    """

    episodes: list[EpisodeView]
    tally: list[TallyView]
    tasks: list[str] = []
    next: Annotated[str | None, Field(examples=[None])] = None


class PolicyView(View):
    """The newest version that a learner announced."""

    version: Version
    created_ns: int
    bank: tuple[str, ...]
    low_level_sha256: str


class LearnerView(View):
    """The learner now: its last heartbeat (as in `LearnerHeartbeat`), and more.

    What is not known is left out: before a learner was heard of that is everything but presence
    and outbox. outbox: corrections and receipts that it does not have yet.
    """

    presence: Presence
    outbox: int
    age_s: float | None = None
    learner: Id | None = None
    time_ns: int | None = None
    state: LearnerState | None = None
    version: Version | None = None
    round: int | None = None
    episodes: int | None = None
    successes: int | None = None
    corrections: int | None = None
    decisions: int | None = None
    reason: str | None = None
    progress: float | None = None
    policy: PolicyView | None = None


class EngineView(View):
    """An engine that recognises speech. install: the command that installs it."""

    engine: Annotated[str, Field(examples=["pocketsphinx"])]
    available: bool
    install: Annotated[str, Field(examples=["pip install 'hl-dagger[speech]'"])]


class SpeechView(View):
    """What speech is recognised here.

    reason: why none is, and what to do. media_type, max_s: what a recording must be.
    commands: what is listened for; other commands can be typed.
    """

    available: bool
    reason: Annotated[str, Field(examples=[""])]
    engines: list[EngineView]
    media_type: Annotated[str, Field(examples=["audio/l16; rate=16000"])]
    max_s: float
    commands: tuple[str, ...]
