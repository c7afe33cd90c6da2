"""What somebody decided about versions and phrases, after the fact; never changed, always kept."""

from enum import StrEnum
from typing import Annotated, Self

from pydantic import Field, StringConstraints, model_validator

from shared.messages.message import Id, Message, Text, TimeNs

Reason = Annotated[str, StringConstraints(max_length=1000, strip_whitespace=True)]


class Verb(StrEnum):
    """What is decided.

    promote: the candidate of a round goes out, although the gate refused it.
    rollback: the weights of an earlier version are in force again, under a new number.
    alias: `phrase` is another wording of `means`, in all labels from the next round on.
    distinct: it is not, and shall not be asked about again.
    """

    PROMOTE = "promote"
    ROLLBACK = "rollback"
    ALIAS = "alias"
    DISTINCT = "distinct"


class Ruling(Message):
    """A decision of a person about what the learner keeps.

    round: of promote, the number of the round. version: of rollback, the number of the version,
        the second half of "1.2". phrase, means: of alias and distinct.
    reason: why, in the person's words.
    """

    id: Id
    verb: Verb
    author: Id
    round: Annotated[int, Field(ge=1)] | None = None
    version: Annotated[int, Field(ge=0)] | None = None
    phrase: Text | None = None
    means: Text | None = None
    reason: Reason = ""
    created_ns: TimeNs

    @model_validator(mode="after")
    def _check_verb(self) -> Self:
        wanted = _NEEDS[self.verb]
        given = {name for name in _FIELDS if getattr(self, name) is not None}
        if given != wanted:
            raise ValueError(f"{self.verb} needs {' and '.join(sorted(wanted))}, and no more")
        if self.phrase is not None and self.phrase == self.means:
            raise ValueError("a phrase can't be another wording of itself")
        return self


_FIELDS = ("round", "version", "phrase", "means")
_NEEDS = {
    Verb.PROMOTE: {"round"},
    Verb.ROLLBACK: {"version"},
    Verb.ALIAS: {"phrase", "means"},
    Verb.DISTINCT: {"phrase", "means"},
}
