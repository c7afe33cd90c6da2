"""A correction that is in force or about to be: what holds, since when, until when."""

from typing import NamedTuple

from shared.messages.goal import Goal


class Override(NamedTuple):
    """A goal that a person set over the high level's.

    correction: the id of the correction. begin: the first control step that obeys it.
    end: the first control step that no longer does; None holds until released.
    """

    correction: str
    goal: Goal
    begin: int
    end: int | None

    def over(self, step: int) -> bool:
        """It has expired by control step `step`."""
        return self.end is not None and step >= self.end
