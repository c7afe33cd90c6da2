"""Account: one episode put together: what π_HL decided, and what stands of what people said.

Where `aggregate.py` begins, and whoever asks what was contradicted or laid on the hand.
"""

from collections import defaultdict
from collections.abc import Sequence
from typing import NamedTuple

from services.learner.labels.amend import Standing, amended
from services.learner.labels.hear import Word, words
from services.learner.store.store import DecisionHead, History
from shared.messages.correction import Kind
from shared.messages.episode import Episode


class Fault(NamedTuple):
    """The command was right and the hand slipped: for whoever trains the low level.

    steps: control steps in which it happened; of a decision without steps those up to the next.
    decisions: those that were taken in them; none of them gives a label.
    """

    correction: str
    author: str
    robot: str
    episode: str
    steps: range
    decisions: tuple[str, ...]


class Account(NamedTuple):
    """One episode.

    heads: its decisions by step. heard: what the robot obeyed, in the order in which it heard it.
    windows: relabels, and overrides that were moved, in the order in which they were said.
    endorsed: what was endorsed, in the same order.
    """

    episode: Episode
    heads: tuple[DecisionHead, ...]
    heard: tuple[Word, ...]
    windows: tuple[Standing, ...]
    faults: tuple[Fault, ...]
    endorsed: tuple[Standing, ...] = ()


def accounts(history: History) -> list[Account]:
    """What happened, episode by episode in the order of their ids."""
    receipts = {one.correction: one for one in history.receipts if one.accepted}
    said: dict[str, list[Standing]] = defaultdict(list)
    for standing in amended(history.corrections, history.receipts):
        said[standing.correction.episode].append(standing)
    decided: dict[str, list[DecisionHead]] = defaultdict(list)
    for head in history.decisions:
        decided[head.episode].append(head)
    found = []
    for episode in sorted(history.episodes, key=lambda episode: episode.id):
        heads = sorted(decided[episode.id], key=lambda head: (head.step, head.id))
        heard = words(said[episode.id], receipts)
        stands = sorted((one for one in said[episode.id] if not one.retracted), key=_order)
        obeyed = {word.correction.id for word in heard}
        windows = tuple(one for one in stands if _is_window(one, obeyed))
        faulty = (one for one in stands if one.correction.kind is Kind.FAULT)
        blamed = tuple(_fault(one, heads, episode.steps) for one in faulty)
        endorsed = tuple(one for one in stands if one.correction.kind is Kind.ENDORSE)
        found.append(Account(episode, tuple(heads), tuple(heard), windows, blamed, endorsed))
    return found


def faults(history: History) -> tuple[Fault, ...]:
    """All that was laid on the hand, in the order of episode and correction."""
    return tuple(fault for account in accounts(history) for fault in account.faults)


def _order(one: Standing) -> tuple[int, str]:
    return one.order


def _is_window(one: Standing, obeyed: set[str]) -> bool:
    """A relabel, or an override that was moved; one that no robot obeyed has nothing to move."""
    kind = one.correction.kind
    moved = kind is Kind.OVERRIDE and one.span is not None and one.correction.id in obeyed
    return kind is Kind.RELABEL or moved


def _fault(one: Standing, heads: Sequence[DecisionHead], end: int) -> Fault:
    said, steps = one.correction, one.span
    named = next((head for head in heads if head.id == said.decision), None)
    if steps is None and named is not None:
        later = (head.step for head in heads if head.step > named.step)
        steps, blamed = range(named.step, next(later, end)), [named.id]
    else:
        steps = steps or range(0)
        blamed = [head.id for head in heads if head.step in steps]
    return Fault(said.id, said.author, said.robot, said.episode, steps, tuple(blamed))
