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


class Overrides:
    """Whose word holds, and whose will: at most one holds at a time."""

    def __init__(self) -> None:
        self.held: Override | None = None
        self._coming: list[Override] = []

    @property
    def held_by(self) -> str | None:
        """The id of the correction that holds."""
        return self.held.correction if self.held else None

    def put(self, override: Override) -> None:
        """It is to hold from its begin on.

        What was to begin earlier still does, as its receipt says; what was to begin later not.
        """
        self._coming = [coming for coming in self._coming if coming.begin < override.begin]
        self._coming.append(override)

    def release(self) -> str | None:
        """What holds does no longer; its id. What is to begin still does."""
        released, self.held = self.held_by, None
        return released

    def expire(self, step: int) -> bool:
        """Let go what has expired; True if something did."""
        expired = self.held is not None and self.held.over(step)
        if expired:
            self.held = None
        return expired

    def begin(self, step: int) -> Override | None:
        """Let the last of those that are due hold, and tell it."""
        begun = None
        while self._coming and step >= self._coming[0].begin:
            begun = self.held = self._coming.pop(0)
        return begun
