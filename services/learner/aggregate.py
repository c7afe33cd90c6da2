"""Derive the labels: which goal should the high level have proposed, where does anybody know?

The second step of a round. Labels are never stored: they are a pure function of what happened
and of a few settings, so that a correction can be taken back and a data set made again.

Source: Ross et al. 2011 (DAgger, arXiv 1011.0686) for aggregation; Kelly et al. 2019 (HG-DAgger,
arXiv 1810.02890): steps that nobody judged are no expert labels; Shi et al. 2024 (arXiv
2403.12910) for language. Unlike the last, the stretch before an override is masked, and the
decision at which it was given is a target.
"""

import hashlib
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from enum import StrEnum
from typing import Annotated, Literal, NamedTuple

from pydantic import Field

from services.learner.store.store import DecisionHead, History
from shared.config import Settings
from shared.messages.correction import Correction, Kind
from shared.messages.receipt import Receipt


class LabelSettings(Settings):
    """How words become labels.

    before_steps: control steps before what a person objected to, in which nothing is a target
        that nobody judged: it may already have been wrong.
    before: what becomes of those decisions, up to the step at which the override took effect.
        mask: no label; relabel: the override's goal, with `before_weight`.
    anticipate_steps: a decision is labelled with what was in force so many steps later, since a
        π_HL that takes so long to answer must say it so much sooner.
    approval_weight: of a decision that was approved; an override has weight 1.
    """

    before_steps: Annotated[int, Field(ge=0, le=10_000)] = 25
    before: Literal["mask", "relabel"] = "mask"
    before_weight: Annotated[float, Field(gt=0, le=10)] = 0.5
    anticipate_steps: Annotated[int, Field(ge=0, le=1_000)] = 0
    approval_weight: Annotated[float, Field(ge=0, le=10)] = 1.0


class Ground(StrEnum):
    """Why a decision has its label.

    objected: an override was given for this very decision. held: an override was in force.
    before: an override was on its way; see `LabelSettings.before`.
    approved: a person said it was right. released: a person let the high level have its way.
    """

    OBJECTED = "objected"
    HELD = "held"
    BEFORE = "before"
    APPROVED = "approved"
    RELEASED = "released"


class Label(NamedTuple):
    """What a decision should have been.

    text: the command, in the spelling of `canonical`. weight: in the loss, > 0.
    correction: the id of the correction that says so.
    """

    decision: str
    episode: str
    text: str
    weight: float
    ground: Ground
    correction: str


class _Word(NamedTuple):
    """A correction that the robot obeyed, with the receipt that says since when."""

    correction: Correction
    receipt: Receipt
    begin: int

    @property
    def order(self) -> tuple[int, int, str]:
        """By when the robot heard it; a later word replaces an earlier one."""
        return (self.receipt.time_ns, self.begin, self.correction.id)


class _Before(NamedTuple):
    """The steps before an override in which what held had already been objected to.

    obeyed: it did take effect, and was not replaced before that.
    """

    steps: range
    word: _Word
    obeyed: bool


class _Hold(NamedTuple):
    """Control steps [begin, end) in which an override was in force."""

    begin: int
    end: int
    word: _Word


def canonical(text: str) -> str:
    """The one spelling of a phrase: lower case, single spaces, no full stop at its end."""
    return " ".join(text.lower().split()).rstrip(".! ") or text


def derive(history: History, settings: LabelSettings, low_level_sha256: str) -> tuple[Label, ...]:
    """The labels of everything that happened, in the order of episode and step.

    The order in which things arrived makes no difference. Episodes that ran another low level
    give none: the right command depends on what the low level can do.
    """
    words = _words(history.corrections, history.receipts)
    decisions = _by_episode(history.decisions)
    labels: list[Label] = []
    for episode in sorted(history.episodes, key=lambda episode: episode.id):
        if episode.low_level_sha256 == low_level_sha256:
            heads = sorted(decisions[episode.id], key=lambda head: (head.step, head.id))
            labels += _judge(heads, words[episode.id], episode.steps, settings)
    return tuple(labels)


def sha256_labels(labels: Iterable[Label]) -> str:
    """One hash over which decision has which label and weight."""
    lines = (f"{label.decision}\t{label.text}\t{label.weight!r}\n" for label in labels)
    return hashlib.sha256("".join(lines).encode()).hexdigest()


def _words(
    corrections: Iterable[Correction], receipts: Iterable[Receipt]
) -> Mapping[str, list[_Word]]:
    """What was said and obeyed in each episode, in the order in which the robot heard it."""
    answers = {receipt.correction: receipt for receipt in receipts if receipt.accepted}
    words: dict[str, list[_Word]] = defaultdict(list)
    for correction in corrections:
        answer = answers.get(correction.id)
        if answer is not None and answer.step is not None:
            words[correction.episode].append(_Word(correction, answer, answer.step))
    for said in words.values():
        said.sort(key=lambda word: word.order)
    return words


def _by_episode(heads: Iterable[DecisionHead]) -> Mapping[str, list[DecisionHead]]:
    grouped: dict[str, list[DecisionHead]] = defaultdict(list)
    for head in heads:
        grouped[head.episode].append(head)
    return grouped


def _judge(
    heads: Sequence[DecisionHead], words: Sequence[_Word], end: int, settings: LabelSettings
) -> list[Label]:
    holds = _holds(words, end)
    befores = _befores(words, holds, settings.before_steps)
    verdicts = _verdicts(words)
    labels = []
    for head in heads:
        word = verdicts.get(head.id)
        label = _held(head, holds, befores, settings)
        approved = word is not None and word.correction.kind is Kind.APPROVE
        if word and (not approved or label is None or label.ground is Ground.BEFORE):
            label = _direct(head, word, settings)
        if label is not None and label.weight > 0:
            labels.append(label)
    return labels


def _holds(words: Iterable[_Word], end: int) -> list[_Hold]:
    """When each override was in force: until it expired, was replaced or released, or the end."""
    holds: list[_Hold] = []
    for word in words:
        if word.correction.kind not in (Kind.OVERRIDE, Kind.RELEASE):
            continue
        # Whatever was to hold beyond this point doesn't, even what had not begun yet.
        cut = (hold._replace(end=min(hold.end, word.begin)) for hold in holds)
        holds = [hold for hold in cut if hold.begin < hold.end]
        if word.correction.kind is Kind.OVERRIDE:
            hold_steps = word.correction.hold_steps
            until = end if hold_steps is None else min(end, word.begin + hold_steps)
            holds.append(_Hold(word.begin, until, word))
    return holds


def _befores(words: Iterable[_Word], holds: Iterable[_Hold], before_steps: int) -> list[_Before]:
    """From before what the person saw up to when each override took effect, in the order heard."""
    obeyed = {hold.word.correction.id for hold in holds if hold.begin < hold.end}
    found = []
    for word in words:
        if word.correction.kind is Kind.OVERRIDE:
            seen = word.correction.seen_step
            first = word.begin if seen is None else min(seen, word.begin)
            steps = range(max(0, first - before_steps), word.begin)
            found.append(_Before(steps, word, word.correction.id in obeyed))
    return found


def _verdicts(words: Iterable[_Word]) -> dict[str, _Word]:
    """The last word about each decision; an approval never has it against an objection.

    Who overrides a decision and then approves, approves of what they said themselves.
    """
    verdicts: dict[str, _Word] = {}
    for word in words:
        decision, kind = word.correction.decision, word.correction.kind
        if decision is None or kind not in (Kind.OVERRIDE, Kind.RELEASE, Kind.APPROVE):
            continue
        if kind is not Kind.APPROVE or decision not in verdicts:
            verdicts[decision] = word
    return verdicts


def _direct(head: DecisionHead, word: _Word, settings: LabelSettings) -> Label:
    """A label from what was said about this very decision."""
    correction = word.correction
    if correction.goal is not None:
        return _label(head, correction.goal.text, 1.0, Ground.OBJECTED, word)
    if correction.kind is Kind.RELEASE:
        return _label(head, head.best, settings.approval_weight, Ground.RELEASED, word)
    return _label(head, head.executed, settings.approval_weight, Ground.APPROVED, word)


def _held(
    head: DecisionHead,
    holds: Iterable[_Hold],
    befores: Iterable[_Before],
    settings: LabelSettings,
) -> Label | None:
    """A label from the override that was in force, or by setting from the one on its way."""
    step = head.step + settings.anticipate_steps
    coming = [before for before in befores if step in before.steps]
    if coming:
        obeyed = [before.word for before in coming if before.obeyed]
        word = min(obeyed, key=lambda word: (word.begin, word.order), default=None)
        if settings.before == "mask" or word is None or word.correction.goal is None:
            return None
        text = word.correction.goal.text
        return _label(head, text, settings.before_weight, Ground.BEFORE, word)
    for hold in holds:
        goal = hold.word.correction.goal
        if hold.begin <= step < hold.end and goal is not None:
            return _label(head, goal.text, 1.0, Ground.HELD, hold.word)
    return None


def _label(head: DecisionHead, text: str, weight: float, ground: Ground, word: _Word) -> Label:
    return Label(head.id, head.episode, canonical(text), weight, ground, word.correction.id)
