"""What people and programs read afterwards: episodes in full, progress, versions and rulings."""

from enum import StrEnum
from typing import Annotated

from pydantic import Field

from services.correction_api.views import CorrectionView, EpisodeView, View
from shared.messages.help import Help
from shared.messages.lineage import RoundTold, Share
from shared.messages.message import Id, TimeNs
from shared.messages.policy import Version
from shared.messages.ruling import Ruling


class EpisodeAccount(View):
    """One episode, as far as this service knows it; its decisions are the learner's to tell.

    episode: null while it runs. corrections: as they were said; more: there are older ones.
    calls: for help, by step.
    """

    id: Annotated[Id, Field(examples=["ep-5f1c"])]
    robot: Annotated[Id, Field(examples=["robot-1"])]
    episode: EpisodeView | None
    corrections: list[CorrectionView]
    more: bool = False
    calls: list[Help]


class VersionProgress(View):
    """One version at work, and evaluated.

    also: what robots call it since a learner took over the store, whose epoch is a later one.
    service: success of its episodes with people, without those broken off; alone: on evaluation
        seeds without people, where it was evaluated, else null.
    corrections: overrides in those episodes. human_s: seconds that people took to say everything
        that they said about them (`shared.messages.correction.speaking_s`).
    """

    version: Annotated[Version, Field(examples=["1.1"])]
    number: int
    also: list[Version] = []
    service: Share | None
    alone: Share | None
    corrections: int
    human_s: float


class Progress(View):
    """All versions that robots ran or that were evaluated, the oldest first."""

    versions: list[VersionProgress]


class VersionView(View):
    """One version. round: that made it. again: the version whose weights it has again.
    ruling: by which it came about. robots: those that alone run it; none named: all."""

    version: Version
    number: int
    created_ns: TimeNs
    round: int | None = None
    again: int | None = None
    ruling: Id | None = None
    robots: tuple[Id, ...] = ()
    in_force: bool


class RoundView(RoundTold):
    """One round; brought: in words, what it brought."""

    brought: str = ""


class RulingState(StrEnum):
    """How far a ruling is: on its way to the learner, there, done, or refused by it."""

    WAITING = "waiting"
    GIVEN = "given"
    DONE = "done"
    REFUSED = "refused"


class RulingView(View):
    """What somebody decided, and what became of it. made: the number of the version that it put
    in force. why: it was refused."""

    ruling: Ruling
    state: RulingState
    made: int | None = None
    why: str = ""


class PolicyHistory(View):
    """How the versions came about, each list the oldest first."""

    version: Version
    versions: list[VersionView]
    rounds: list[RoundView]
    rulings: list[RulingView]


class ReportBrief(View):
    """Whether an experiment was measured; hint: what to do where it was not."""

    name: Annotated[str, Field(examples=["horizon"])]
    measured: bool
    hint: str = ""


class Reports(View):
    """All experiments whose figures the page can show."""

    reports: list[ReportBrief]
