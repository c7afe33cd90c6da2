"""A robot with as much to say as a real one: eleven proposals, two of them of two lines."""

from shared.messages.decision import Decision, Proposal
from shared.messages.goal import LanguageGoal
from shared.wire.codec import encode
from shared.wire.keys import robot_key
from tests.integration.correction_api.fakes import FLEET, FakeRobot

LONG = (
    "pick up the cheese",
    "pick up the lettuce",
    "pick up the slice of tomato on the left",  # As somebody taught it.
    "put it on the plate",
    "pick up the bread",
    "pick up the wrapper",
    "put it down beside the cutting board",
    "pick up the saucer",
    "pick up the toast",
    "put it in the tub",
    "wait",
)


class CrowdedRobot(FakeRobot):
    """Proposes `LONG` at each decision."""

    def repeat(self, decision: Decision) -> None:
        """Publish a decision, with the long proposals."""
        share = 2 / (len(LONG) * (len(LONG) + 1))
        proposed = tuple(
            Proposal(goal=LanguageGoal(text=text), score=share * (len(LONG) - rank))
            for rank, text in enumerate(LONG)
        )
        told = decision.model_copy(update={"proposed": proposed})
        self.bus.put(robot_key(FLEET, self.name, "decision"), encode(told))
