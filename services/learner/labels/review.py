"""Review: what people still have to settle: who contradicts whom, and which phrases mean the same.

After `aggregate.py` has left out what is disputed; a pure function, asked by `questions.py`.
"""

from collections import Counter
from collections.abc import Callable, Iterable
from typing import NamedTuple

from services.learner.labels.account import accounts
from services.learner.labels.aggregate import Dispute, LabelSettings, disputes
from services.learner.labels.amend import amended
from services.learner.labels.dispute import Opinion
from services.learner.labels.spell import canonical, spelling
from services.learner.store.store import History
from shared.messages.ruling import Verb

Meaning = Callable[[str], str | None]
"""From a phrase to the command that the low level takes it for; None where it understands none."""


class Contradiction(NamedTuple):
    """Two corrections of two people that say different things about the same decisions.

    steps: of the first and the last of the decisions.
    """

    episode: str
    steps: tuple[int, int]
    decisions: tuple[str, ...]
    one: Opinion
    other: Opinion


class Wording(NamedTuple):
    """A phrase that seems to be another wording of a command. times: how often it was said."""

    phrase: str
    means: str
    times: int


class Review(NamedTuple):
    """What is open. faults: how often something was laid on the hand, which needs no answer."""

    contradictions: tuple[Contradiction, ...]
    wordings: tuple[Wording, ...]
    faults: int


def review(
    history: History, settings: LabelSettings, known: Iterable[str], meaning: Meaning
) -> Review:
    """Everything that is open.

    known: the commands that the first version had; they are no wordings of each other.
    """
    faults = sum(len(account.faults) for account in accounts(history))
    wordings = _wordings(history, {canonical(phrase) for phrase in known}, meaning)
    return Review(_contradictions(disputes(history, settings)), wordings, faults)


def _contradictions(found: Iterable[Dispute]) -> tuple[Contradiction, ...]:
    grouped: dict[tuple[str, str, str], list[Dispute]] = {}
    for dispute in found:
        key = (dispute.episode, dispute.one.correction, dispute.other.correction)
        grouped.setdefault(key, []).append(dispute)
    return tuple(
        Contradiction(
            episode=group[0].episode,
            steps=(group[0].step, group[-1].step),
            decisions=tuple(dispute.decision for dispute in group),
            one=group[0].one,
            other=group[0].other,
        )
        for group in grouped.values()
    )


def _wordings(history: History, known: set[str], meaning: Meaning) -> tuple[Wording, ...]:
    """Phrases that were said, are no command, and of which nobody ruled yet what they mean."""
    spell = spelling(history.rulings)
    said = Counter(
        spell(standing.correction.goal.text)
        for standing in amended(history.corrections, history.receipts)
        if standing.correction.goal is not None and not standing.retracted
    )
    ruled = {
        frozenset({canonical(ruling.phrase), canonical(ruling.means)})
        for ruling in history.rulings
        if ruling.verb is Verb.DISTINCT and ruling.phrase and ruling.means
    }
    found = []
    for phrase in sorted(said.keys() - known):
        means = meaning(phrase)
        means = means if means is None else spell(means)
        if means not in (None, phrase) and frozenset({phrase, means}) not in ruled:
            found.append(Wording(phrase, means or "", said[phrase]))
    return tuple(found)
