"""Hear: what a robot obeyed in an episode, over which steps, and when the person began to speak.

The second part of `aggregate.py`, from what stands (`amend.py`) and from what the robot answered.
"""

from bisect import bisect_right
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from services.learner.labels.amend import Standing
from services.learner.store.store import DecisionHead
from shared.messages.correction import Correction, Kind
from shared.messages.receipt import Receipt

HEARD = (Kind.OVERRIDE, Kind.RELEASE, Kind.APPROVE)
"""Kinds that say something about what a robot is doing."""


class Word(NamedTuple):
    """A correction that the robot obeyed from step `begin` on.

    stands: False where it was taken back or moved: the robot obeyed it, but no label comes of it.
    """

    correction: Correction
    begin: int
    heard_ns: int
    stands: bool

    @property
    def order(self) -> tuple[int, int, str]:
        """By when the robot heard it; a later word replaces an earlier one."""
        return (self.heard_ns, self.begin, self.correction.id)


class Hold(NamedTuple):
    """Control steps [begin, end) in which an override was in force."""

    begin: int
    end: int
    word: Word


class Before(NamedTuple):
    """The steps before an override in which what held had already been objected to.

    obeyed: it did take effect, and was not replaced before that.
    """

    steps: range
    word: Word
    obeyed: bool


def words(standing: Iterable[Standing], receipts: Mapping[str, Receipt]) -> list[Word]:
    """What was said and obeyed in one episode, in the order in which the robot heard it.

    receipts: the accepted ones, by correction.
    """
    found = []
    for one in standing:
        answer = receipts.get(one.correction.id)
        if one.correction.kind not in HEARD or answer is None or answer.step is None:
            continue
        stands = not one.retracted and one.span is None
        found.append(Word(one.correction, answer.step, answer.time_ns, stands))
    return sorted(found, key=lambda word: word.order)


def holds(heard: Iterable[Word], end: int) -> list[Hold]:
    """When each override was in force: until it expired, was replaced or released, or the end.

    A word that was taken back still ended what held before it: from there on the robot did
    something else, and nobody said then that the earlier goal was right for what came of it.
    """
    found: list[Hold] = []
    for word in heard:
        if word.correction.kind is Kind.APPROVE:
            continue
        overrides = word.correction.kind is Kind.OVERRIDE
        # Whatever was to hold beyond this point doesn't; a release leaves what has not
        # begun yet, as on the robot (`shared/rollout/override.py`).
        cut = (
            hold._replace(end=min(hold.end, word.begin))
            if overrides or hold.begin <= word.begin
            else hold
            for hold in found
        )
        found = [hold for hold in cut if hold.begin < hold.end]
        if overrides:
            hold_steps = word.correction.hold_steps
            until = end if hold_steps is None else min(end, word.begin + hold_steps)
            found.append(Hold(word.begin, until, word))
    return [hold for hold in found if hold.word.stands]


def befores(
    heard: Iterable[Word],
    held: Iterable[Hold],
    heads: Sequence[DecisionHead],
    before_steps: int,
    control_hz: float,
) -> list[Before]:
    """From before what the person saw up to when each override took effect, in the order heard.

    heads: the decisions of the episode by step.
    """
    obeyed = {hold.word.correction.id for hold in held if hold.begin < hold.end}
    found = []
    for word in heard:
        if word.correction.kind is Kind.OVERRIDE and word.stands:
            first = min(onset(word, heads, control_hz), word.begin)
            steps = range(max(0, first - before_steps), word.begin)
            found.append(Before(steps, word, word.correction.id in obeyed))
    return found


def onset(word: Word, heads: Sequence[DecisionHead], control_hz: float) -> int:
    """The first control step that the person can have objected to, but for their reaction time.

    The earlier one of what they say they saw and of what was current when they began to speak.
    The latter goes by the times of the decisions, and by `control_hz` in between, but never beyond
    the next decision: while a robot waits for a verdict, time passes and no steps do. Whoever has
    a delay in steps spoke while the robot stood at a decision. All clocks are taken to agree.

    heads: the decisions of the episode by step; those without a time tell nothing.
    """
    correction = word.correction
    seen = word.begin if correction.seen_step is None else correction.seen_step
    timed = [(head.time_ns, head.step) for head in heads if head.time_ns is not None]
    last = bisect_right([time_ns for time_ns, _ in timed], correction.begun_ns) - 1
    if last < 0:
        return seen
    time_ns, step = timed[last]
    if correction.delay_steps == 0:
        following = timed[last + 1][1] if last + 1 < len(timed) else word.begin
        passed = int((correction.begun_ns - time_ns) * control_hz / 1e9)
        step = min(step + passed, max(step, following))
    return min(seen, step)


class Course(NamedTuple):
    """What people's words made of an episode while it ran."""

    holds: Sequence[Hold]
    befores: Sequence[Before]

    def held(self, step: int) -> Word | None:
        """The override that was in force at a step."""
        return next((hold.word for hold in self.holds if hold.begin <= step < hold.end), None)

    def coming(self, step: int) -> list[Before]:
        """The overrides for which what was in force at a step had already been objected to."""
        return [before for before in self.befores if step in before.steps]


def verdicts(heard: Iterable[Word]) -> dict[str, Word]:
    """The last word about each decision; an approval never has it against an objection.

    Who overrides a decision and then approves, approves of what they said themselves; who lets go
    then has not taken back that it was wrong.
    """
    found: dict[str, Word] = {}
    for word in heard:
        decision, kind = word.correction.decision, word.correction.kind
        if decision is None or not word.stands:
            continue
        before = found.get(decision)
        objected = before is not None and before.correction.kind is Kind.OVERRIDE
        if before is None or kind is Kind.OVERRIDE or (kind is Kind.RELEASE and not objected):
            found[decision] = word
    return found
