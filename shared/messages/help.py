"""A robot's call for help: it is in doubt, or makes no progress, and asks for a person's word."""

from enum import StrEnum
from typing import Annotated

from pydantic import Field

from shared.messages.message import Id, Message, Step, TimeNs


class Reason(StrEnum):
    """Why a robot asks.

    entropy: the high level hesitates between many goals. margin: its best two are close.
    stuck: one command is in force for long, and nothing comes of it.
    """

    ENTROPY = "entropy"
    MARGIN = "margin"
    STUCK = "stuck"


class Help(Message):
    """A call for help that is open: nobody has answered, and the doubt has not gone.

    decision: the decision at which the robot began to ask; one call is told by it.
    step, time_ns: of that decision.
    doubt: from 0, sure, to 1, as it is now; `services/actor/doubt.py` says how it is reckoned.
    waits_s: how much longer the robot stands still for an answer at most, seconds from the
        message that carries this; 0: it doesn't, and goes on in doubt.
    """

    decision: Id
    step: Step
    time_ns: TimeNs
    reason: Reason
    doubt: Annotated[float, Field(ge=0, le=1)]
    waits_s: Annotated[float, Field(ge=0)] = 0.0
