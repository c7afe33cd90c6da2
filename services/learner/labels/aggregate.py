"""Derive the labels: which goal should the high level have proposed, where does anybody know?

The second step of a round. Labels are never stored: they are a pure function of what happened
and of a few settings, so that a correction can be taken back and a data set made again.

Source: Ross et al. 2011 (DAgger, arXiv 1011.0686) for aggregation; Kelly et al. 2019 (HG-DAgger,
arXiv 1810.02890): steps that nobody judged are no expert labels; Shi et al. 2024 (arXiv
2403.12910) for language. Unlike the last, the stretch before an override is masked, and the
decision at which it was given is a target.

Part by part: `amend.py` what stands, `hear.py` what was obeyed when, `account.py` both by episode,
`dispute.py` who contradicts whom, `spell.py` in which words.
"""

import hashlib
from collections.abc import Iterable, Iterator
from enum import StrEnum
from typing import Annotated, Literal, NamedTuple

from pydantic import Field

from services.learner.labels.account import Account, accounts
from services.learner.labels.amend import Standing
from services.learner.labels.dispute import Opinion, Opinions, later, text_of
from services.learner.labels.hear import Course, befores, holds, verdicts
from services.learner.labels.spell import Spelling, spelling
from services.learner.store.store import DecisionHead, History
from shared.config import Settings
from shared.messages.correction import Correction, Kind
from shared.messages.policy import is_version


class LabelSettings(Settings):
    """How words become labels.

    before_steps: a person's reaction time: control steps before what they saw, or before they
        began to speak, in which nothing is a target that nobody judged: it may already have been
        wrong.
    before: what becomes of those decisions, up to the step at which the override took effect.
        mask: no label; relabel: the override's goal, with `before_weight`; keep: whatever was in
        force, which is there to be compared with.
    control_hz: control steps a second of robots in real time, to tell what was current when a
        person began to speak.
    anticipate_steps: a decision is labelled with what was in force, or should have been, so many
        steps later, since a π_HL that takes so long to answer must say it so much sooner.
    approval_weight: of a decision that was approved or endorsed; an override has weight 1.
    disputed: of decisions of which two people say different things. mask: no label until one of
        the words is taken back or edited, or both are ruled to mean the same; later: as if one
        person had said both.
    """

    before_steps: Annotated[int, Field(ge=0, le=10_000)] = 25
    before: Literal["mask", "relabel", "keep"] = "mask"
    before_weight: Annotated[float, Field(gt=0, le=10)] = 0.5
    control_hz: Annotated[float, Field(gt=0, le=1000)] = 50.0
    anticipate_steps: Annotated[int, Field(ge=0, le=1_000)] = 0
    approval_weight: Annotated[float, Field(ge=0, le=10)] = 1.0
    disputed: Literal["mask", "later"] = "mask"


class Ground(StrEnum):
    """Why a decision has its label.

    objected: an override was given for this very decision. held: an override was in force, or
        was said afterwards to have been the right one then.
    before: an override was on its way; see `LabelSettings.before`.
    approved: a person said it was right. released: a person let the high level have its way.
    relabelled: a person said afterwards what would have been right. endorsed: or that all was.
    """

    OBJECTED = "objected"
    HELD = "held"
    BEFORE = "before"
    APPROVED = "approved"
    RELEASED = "released"
    RELABELLED = "relabelled"
    ENDORSED = "endorsed"


class Label(NamedTuple):
    """What a decision should have been.

    text: the command, in the spelling of `spell.py`. weight: in the loss, > 0.
    correction: the id of the correction that says so.
    """

    decision: str
    episode: str
    text: str
    weight: float
    ground: Ground
    correction: str


class _Said(NamedTuple):
    """What is said about a decision, not yet put into the words of a label."""

    correction: Correction
    weight: float
    ground: Ground


class Dispute(NamedTuple):
    """Two people who judge one decision differently."""

    episode: str
    decision: str
    step: int
    one: Opinion
    other: Opinion


def derive(history: History, settings: LabelSettings, low_level_sha256: str) -> tuple[Label, ...]:
    """The labels of everything that happened, in the order of episode and step.

    The order in which things arrived makes no difference. Episodes that ran another low level
    give none: the right command depends on what the low level can do.
    """
    spell = spelling(history.rulings)
    return tuple(
        label
        for account in accounts(history)
        if account.episode.low_level_sha256 == low_level_sha256
        for label in _Judge(account, settings, spell).labels()
    )


def disputes(history: History, settings: LabelSettings) -> tuple[Dispute, ...]:
    """All that two people contradict each other about, in the order of episode and step."""
    spell = spelling(history.rulings)
    return tuple(
        Dispute(head.episode, head.id, head.step, *pair)
        for account in accounts(history)
        for head, pairs in _Judge(account, settings, spell).disputes()
        for pair in pairs
    )


def sha256_labels(labels: Iterable[Label]) -> str:
    """One hash over which decision has which label and weight."""
    lines = (f"{label.decision}\t{label.text}\t{label.weight!r}\n" for label in labels)
    return hashlib.sha256("".join(lines).encode()).hexdigest()


class _Judge:
    """What the decisions of one episode should have been."""

    def __init__(self, account: Account, settings: LabelSettings, spell: Spelling) -> None:
        self._account, self._settings, self._spell = account, settings, spell
        held = holds(account.heard, account.episode.steps)
        before_steps, hz = settings.before_steps, settings.control_hz
        self._course = Course(held, befores(account.heard, held, account.heads, before_steps, hz))
        self._verdicts = verdicts(account.heard)
        self._opinions = Opinions(account, self._course, spell, settings.approval_weight > 0)
        self._blamed = {id_ for fault in account.faults for id_ in fault.decisions}

    def labels(self) -> Iterator[Label]:
        """By step; decisions at which the hand slipped, and disputed ones, have none."""
        mask = self._settings.disputed == "mask"
        disputed = {head.id for head, _ in self.disputes()} if mask else set()
        for head in self._account.heads:
            if head.id not in self._blamed and head.id not in disputed:
                label = self._label(head)
                if label is not None and label.weight > 0:
                    yield label

    def disputes(self) -> Iterator[tuple[DecisionHead, list[tuple[Opinion, Opinion]]]]:
        """The decisions that two people judge differently, by step."""
        for head in self._account.heads:
            pairs = self._opinions.disputed(head, self._step(head))
            if pairs:
                yield head, pairs

    def _step(self, head: DecisionHead) -> int:
        return head.step + self._settings.anticipate_steps

    def _label(self, head: DecisionHead) -> Label | None:
        """What was said last of the past, or else what was said while it was the present.

        Only an override that was said later still, of this very decision or in force at its step,
        stands against what was said of the past.
        """
        said, window = self._said(head), self._window(head)
        if said is not None and window is not None:
            override = said.ground in (Ground.OBJECTED, Ground.HELD)
            window = None if override and later(said.correction, window.order) else window
        if window is not None:
            relabel = window.correction.kind is Kind.RELABEL
            ground = Ground.RELABELLED if relabel else Ground.HELD
            said = _Said(window.correction, 1.0, ground)
        return None if said is None else self._make(head, said)

    def _make(self, head: DecisionHead, said: _Said) -> Label:
        text = self._spell(text_of(said.correction, head))
        return Label(head.id, head.episode, text, said.weight, said.ground, said.correction.id)

    def _window(self, head: DecisionHead) -> Standing | None:
        """What was said last of the past about the step of a decision."""
        step = self._step(head)
        covers = (one for one in self._account.windows if one.span and step in one.span)
        return max(covers, key=lambda one: one.order, default=None)

    def _said(self, head: DecisionHead) -> _Said | None:
        """What was said of this very decision, or else while an override held or was coming."""
        held, word = self._held(self._step(head)), self._verdicts.get(head.id)
        if word is None:
            return held or self._endorsed(head)
        kind, weight = word.correction.kind, self._settings.approval_weight
        if kind is Kind.OVERRIDE:
            return _Said(word.correction, 1.0, Ground.OBJECTED)
        if kind is Kind.RELEASE:
            return _Said(word.correction, weight, Ground.RELEASED)
        if held is None or held.ground is Ground.BEFORE:
            return _Said(word.correction, weight, Ground.APPROVED)
        return held

    def _endorsed(self, head: DecisionHead) -> _Said | None:
        """That the high level was right where nobody spoke.

        Not where an override was on its way, since the person had already seen something wrong; not
        where somebody's word held, which is judged by itself or was taken back.
        """
        step = self._step(head)
        if self._course.coming(step) and self._settings.before != "keep":
            return None
        if not is_version(head.chosen_by):
            return None
        covers = (one for one in self._account.endorsed if one.span and step in one.span)
        last = max(covers, key=lambda one: one.order, default=None)
        weight = self._settings.approval_weight
        return None if last is None else _Said(last.correction, weight, Ground.ENDORSED)

    def _held(self, step: int) -> _Said | None:
        """The override that was in force, or by setting the one on its way."""
        coming = self._course.coming(step) if self._settings.before != "keep" else []
        if coming:
            obeyed = [before.word for before in coming if before.obeyed]
            word = min(obeyed, key=lambda word: (word.begin, word.order), default=None)
            if self._settings.before == "mask" or word is None:
                return None
            return _Said(word.correction, self._settings.before_weight, Ground.BEFORE)
        held = self._course.held(step)
        return None if held is None else _Said(held.correction, 1.0, Ground.HELD)
