"""The actor's answer to a correction."""

from typing import Self

from pydantic import model_validator

from shared.messages.message import Id, Message, Step, TimeNs


class Receipt(Message):
    """In force since step s, or refused because of a reason; the same one for a repeated id.

    step: the first control step that obeys; None when it was refused.
    replaced: the id of the correction that held until then, if one did.
    """

    correction: Id
    robot: Id
    episode: Id
    accepted: bool
    step: Step | None = None
    replaced: Id | None = None
    reason: str = ""
    time_ns: TimeNs

    @model_validator(mode="after")
    def _check_outcome(self) -> Self:
        if self.accepted != (self.step is not None):
            raise ValueError("an accepted correction has a step, a refused one has none")
        if not self.accepted and not self.reason:
            raise ValueError("a refusal says why")
        return self
