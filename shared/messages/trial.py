"""Episodes that the learner's gate wants rolled out, and what came of them.

Actors in evaluation mode ask for one after the other: the answer to a report is the next order.
"""

from typing import Any

from pydantic import Field

from shared.messages.message import Id, Message, Step
from shared.messages.policy import PolicyAnnouncement, Sha256


class TrialOrder(Message):
    """One episode to be rolled out without people.

    policy: what to roll out; its tensors are fetched as those of any announcement. policy_sha256:
        over all that makes it act. plan: site, tasks, rollout and so on, as an evaluation takes
        them, as JSON values; plan_sha256: over it and the code that hands it out.
    seed: of the scene, as evaluations count them. task: of the episode.
    """

    policy: PolicyAnnouncement
    policy_sha256: Sha256
    plan: dict[str, Any]
    plan_sha256: Sha256
    seed: Step
    task: Id


class TrialResult(Message):
    """What came of an order. row: what `hld evaluate` keeps of an episode, as JSON values."""

    policy_sha256: Sha256
    plan_sha256: Sha256
    seed: Step
    success: bool
    row: dict[str, Any]


class TrialReport(Message):
    """An actor asks for work, and hands in what it did; handing it in again changes nothing.

    low_level_sha256: the low level that it runs; it gets orders for that one alone.
    """

    evaluator: Id
    low_level_sha256: Sha256
    result: TrialResult | None = Field(default=None)
