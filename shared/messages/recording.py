"""An episode looked at again: what the high level decided in it, and a picture that it saw."""

from typing import Annotated

from pydantic import Field

from shared.messages.decision import Asked, Choice, Proposal
from shared.messages.goal import Goal
from shared.messages.help import Help
from shared.messages.message import ArraySpec, Id, Message, Step, Text, TimeNs
from shared.messages.policy import Version

MAX_DECISIONS = 200
MAX_PROPOSED = 8
MAX_JPEG_BYTES = 1 << 20


class RecordingQuery(Message):
    """Asks for decisions of an episode, from index `first` on, at most `limit` of them."""

    episode: Id
    first: Step = 0
    limit: Annotated[int, Field(ge=1, le=MAX_DECISIONS)] = MAX_DECISIONS


class Recorded(Message):
    """A decision without its pictures and without what only a scripted person may know.

    proposed: the best few. entropy: over all of them, in nats. The rest: as in `Decision`.
    """

    id: Id
    index: Step
    step: Step
    time_ns: TimeNs
    asked: Asked | None = None
    prompt: Text
    proposed: tuple[Proposal, ...]
    entropy: float
    executed: Goal
    chosen_by: str
    choice: Choice | None = None
    version: Version
    help: Help | None = None


class Recording(Message):
    """Decisions of one episode by index; none where the learner has none of it.

    robot: whose it is; None where there is no decision.
    next: the index from which to ask for more; None: there are no more yet.
    """

    episode: Id
    robot: Id | None = None
    decisions: tuple[Recorded, ...] = ()
    next: Step | None = None


class StillQuery(Message):
    """Asks for what one camera showed the high level at a decision."""

    decision: Id
    camera: Id


class Still(Message):
    """A picture as the high level saw it, `IMAGE_PX` square.

    arrays: jpeg [L] uint8, a JPEG file.
    """

    ARRAYS = {"jpeg": ArraySpec("uint8", (None,), limit=MAX_JPEG_BYTES)}

    decision: Id
    camera: Id
    step: Step
