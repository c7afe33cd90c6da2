"""Dispute: which decisions do two people judge differently?

A part of `aggregate.py`, which leaves them out until somebody settles it, and of the review list.
"""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from enum import IntEnum
from itertools import combinations
from typing import NamedTuple

from services.learner.labels.account import Account
from services.learner.labels.hear import Course, Word, verdicts
from services.learner.labels.spell import Spelling
from services.learner.store.store import DecisionHead
from shared.messages.correction import Correction, Kind


class Nearness(IntEnum):
    """How near words come to a decision.

    held: an override was in force at its step. named: they are about this very decision.
    looked_back: they are about steps that were named afterwards, its own among them.
    """

    HELD = 0
    NAMED = 1
    LOOKED_BACK = 2


class Opinion(NamedTuple):
    """What one person thinks of a decision."""

    author: str
    correction: str
    text: str
    nearness: Nearness


class Opinions:
    """What each person thinks of the decisions of one episode, by their own words alone."""

    def __init__(self, account: Account, course: Course, spell: Spelling, approvals: bool) -> None:
        """approvals: what was approved and released counts, too."""
        self._account, self._course, self._spell = account, course, spell
        self._verdicts = _by_author(account.heard, approvals)
        self._faults = {
            (fault.author, id_): fault for fault in account.faults for id_ in fault.decisions
        }
        told = {window.correction.author for window in account.windows}
        blaming = {fault.author for fault in account.faults}
        self._authors = sorted({*self._verdicts, *told, *blaming})

    def disputed(self, head: DecisionHead, step: int) -> list[tuple[Opinion, Opinion]]:
        """The pairs of opinions that contradict each other about a decision.

        An override that only went on being in force contradicts nobody who spoke later, since the
        time for what it said may have passed; but it does those who looked back at the same steps.
        Where the hand is blamed there is no label to disagree about, but for who says that the
        command was right after all.

        step: at which it was to be in force, see `LabelSettings.anticipate_steps`.
        """
        if len(self._authors) < 2:
            return []
        opinions = [self._opinion(author, head, step) for author in self._authors]
        pairs = combinations([one for one in opinions if one is not None], 2)
        blamed = {fault.correction for (_, id_), fault in self._faults.items() if id_ == head.id}
        return [
            (one, other)
            for one, other in pairs
            if _contradict(one, other)
            and (not blamed or blamed & {one.correction, other.correction})
        ]

    def _opinion(self, author: str, head: DecisionHead, step: int) -> Opinion | None:
        if fault := self._faults.get((author, head.id)):
            held = self._course.held(head.step)
            right = head.executed if held is None else text_of(held.correction, head)
            return Opinion(author, fault.correction, self._spell(right), Nearness.NAMED)
        named = self._verdicts.get(author, {}).get(head.id)
        windows = (
            one
            for one in reversed(self._account.windows)
            if one.correction.author == author and one.span is not None and step in one.span
        )
        window = next(windows, None)
        if window is not None and not (named and later(named.correction, window.order)):
            return self._of(window.correction, head, Nearness.LOOKED_BACK)
        if named is not None:
            return self._of(named.correction, head, Nearness.NAMED)
        held = None if self._course.coming(step) else self._course.held(step)
        if held is not None and held.correction.author == author:
            return self._of(held.correction, head, Nearness.HELD)
        return None

    def _of(self, said: Correction, head: DecisionHead, nearness: Nearness) -> Opinion:
        return Opinion(said.author, said.id, self._spell(text_of(said, head)), nearness)


def text_of(said: Correction, head: DecisionHead) -> str:
    """What a correction that names a decision, or covers it, says would have been right."""
    if said.goal is not None:
        return said.goal.text
    return head.best if said.kind is Kind.RELEASE else head.executed


def later(said: Correction, order: tuple[int, str]) -> bool:
    """Whether an override was said after something that was said of the past."""
    return said.kind is Kind.OVERRIDE and (said.created_ns, said.id) > order


def _contradict(one: Opinion, other: Opinion) -> bool:
    near = {one.nearness, other.nearness}
    return one.text != other.text and near not in ({Nearness.HELD}, {Nearness.HELD, Nearness.NAMED})


def _by_author(heard: Sequence[Word], approvals: bool) -> Mapping[str, dict[str, Word]]:
    words: dict[str, list[Word]] = defaultdict(list)
    for word in heard:
        if approvals or word.correction.kind is Kind.OVERRIDE:
            words[word.correction.author].append(word)
    return {author: verdicts(said) for author, said in words.items()}
