"""Which corrections went into which version; asked of the learner for a bounded lot at a time."""

from typing import Annotated

from pydantic import Field

from shared.messages.message import Id, Message
from shared.messages.policy import Version

MAX_ASKED = 500

Asked = Annotated[tuple[Id, ...], Field(max_length=MAX_ASKED)]


class LearnedQuestion(Message):
    """Somebody wants to know what became of these corrections."""

    corrections: Asked


class LearnedAnswer(Message):
    """What is known of those that were asked about; of the others nothing has been learned yet.

    learned: the first version that was trained with a label of the correction and put in force,
        under the name that it was made with. A rollback doesn't change it.
    held_out: those that are kept aside to judge versions by, and that none was trained with so far.
    """

    learned: dict[Id, Version] = Field(default_factory=dict)
    held_out: Asked = ()
