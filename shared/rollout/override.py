"""A correction that is in force or about to be: what holds, since when, until when."""

from collections.abc import Callable
from typing import NamedTuple

from shared.messages.correction import Correction
from shared.messages.goal import Goal


class Override(NamedTuple):
    """A goal that a person set over the high level's.

    correction: the id of the correction. begin: the first control step that obeys it.
    end: the first control step that no longer does; None holds until released.
    said: its goal as it was said. edits: what it was put otherwise by, with the goals; the last
        one counts.
    """

    correction: str
    said: Goal
    begin: int
    end: int | None
    edits: tuple[tuple[str, Goal], ...] = ()

    @property
    def goal(self) -> Goal:
        """What is to be done."""
        return self.edits[-1][1] if self.edits else self.said

    def over(self, step: int) -> bool:
        """It has expired by control step `step`."""
        return self.end is not None and step >= self.end


def override_of(correction: Correction, step: int, awaited_step: int | None) -> Override:
    """What a correction of this kind asks for, heard before control step `step`.

    awaited_step: of the decision that waits for a verdict, from which on the delay counts.
    """
    assert correction.goal is not None  # Its model says so.
    begin = step
    if correction.delay_steps and awaited_step is not None:
        begin = max(begin, awaited_step + correction.delay_steps)
    end = begin + correction.hold_steps if correction.hold_steps else None
    return Override(correction.id, correction.goal, begin, end)


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

    def knows(self, correction: str | None) -> bool:
        """Whether the override of this correction holds or is to begin."""
        known = [coming.correction for coming in self._coming]
        return correction is not None and correction in (self.held_by, *known)

    def withdraw(self, correction: str | None) -> str | None:
        """One that should not have been said holds no longer, and will not begin.

        Returns its id where it held. What it replaced is not brought back.
        """
        self._coming = [coming for coming in self._coming if coming.correction != correction]
        return self.release() if correction and correction == self.held_by else None

    def reword(self, edit: Correction) -> Override | None:
        """The target of an edit has its goal from now on, for as long as it was to hold.

        Returns it where it holds.
        """
        assert edit.goal is not None  # Its model says so.
        added = ((edit.id, edit.goal),)
        return self._amend(
            lambda one: one.edits + added if one.correction == edit.target else one.edits
        )

    def unsay(self, edit: str | None) -> Override | None:
        """An edit that should not have been said: its target is put again as it was before.

        Returns it where it holds.
        """
        return self._amend(lambda one: tuple(kept for kept in one.edits if kept[0] != edit))

    def _amend(self, edits: Callable[[Override], tuple[tuple[str, Goal], ...]]) -> Override | None:
        self._coming = [coming._replace(edits=edits(coming)) for coming in self._coming]
        if self.held is None:
            return None
        before, self.held = self.held, self.held._replace(edits=edits(self.held))
        return self.held if self.held.edits != before.edits else None

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
