"""What labelled decisions look like to the network, and how far a version agrees with them.

Between `aggregate` and training: pictures and words as the high level was shown them, from the
store; the bank, with every phrase that a label holds.
"""

from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from functools import cache

import numpy as np
from numpy.typing import NDArray

from services.learner.labels.aggregate import Label
from services.learner.labels.spell import Spelling, canonical
from services.learner.publish import announcement
from services.learner.store.store import PolicyRecord, Store
from services.learner.store.tensors import TensorFiles, unpack
from shared.errors import RefusedError
from shared.goals.language.bank import PhraseBank
from shared.messages.decision import Decision
from shared.messages.observation import Observation
from shared.policies.examples import Examples
from shared.policies.fit import agreement
from shared.policies.high_level import HighLevel


def open_version(record: PolicyRecord, files: TensorFiles) -> HighLevel:
    """A kept version, ready to be asked or trained."""
    tensors = {ref.name: unpack(ref, files.get(ref.sha256)) for ref in record.tensors}
    return HighLevel.build(announcement(record, record.epoch, "learner"), tensors)


def renew(
    bank: PhraseBank, first: Iterable[str], labels: Sequence[Label]
) -> tuple[PhraseBank, dict[str, str]]:
    """A bank that holds every label and all of the first bank, and how it spells each.

    A phrase that nobody used before is added at the end: the head compares vectors, so it needs
    no new weights. One that was learned and that no label has any more, since it was taken back or
    put otherwise, leaves: what can't be proposed is not said.
    """
    held = {canonical(phrase) for phrase in first} | {label.text for label in labels}
    rows = [row for row, phrase in enumerate(bank.phrases) if canonical(phrase) in held]
    bank = PhraseBank(tuple(bank.phrases[row] for row in rows), bank.vectors[rows])
    spelling = {canonical(phrase): phrase for phrase in reversed(bank.phrases)}
    for label in labels:
        if label.text not in spelling:
            bank = bank.add(label.text)
            spelling[label.text] = label.text
    return bank, spelling


def unread(
    labels: Sequence[Label], known: Iterable[str], meaning: Callable[[str], str | None]
) -> tuple[str, ...]:
    """The phrases of labels that the low level takes for no command: nobody could obey them.

    known: phrases that need not be read, since demonstrations hold them. meaning: the command that
        the low level takes a phrase for; None where it understands none.
    """
    old = {canonical(phrase) for phrase in known}
    new = {label.text for label in labels if label.text not in old}
    return tuple(sorted(text for text in new if meaning(text) is None))


def meant(spell: Spelling, known: Iterable[str], meaning: Callable[[str], str | None]) -> Spelling:
    """What a phrase asks for, however it is put: two that a robot obeys alike are the same.

    A version in force can't say the words that people began to use since; held against words, it
    would be wrong in each of them, and whatever is made of them would be better.

    known, meaning: as for `unread`.
    """
    old = {canonical(phrase) for phrase in known}

    @cache
    def asked(text: str) -> str:
        text = spell(text)
        return text if text in old else meaning(text) or text

    return asked


def gather(labels: Sequence[Label], spelling: dict[str, str], store: Store) -> Examples:
    """The labelled decisions as the network reads them: what the high level saw, as it saw it."""
    seen = [*store.decisions(label.decision for label in labels)]
    looks = [[*_past(decision), decision.id] for decision in seen]
    shown = _shown((name for names in looks for name in names), store)
    number = {name: row for row, name in enumerate(shown)}
    rows = np.full((len(looks), max(map(len, looks))), -1)
    for row, names in zip(rows, looks, strict=True):
        row[len(row) - len(names) :] = [number.get(name, -1) for name in names]
    return Examples(
        images=np.stack([*shown.values()]),
        prompts=[decision.prompt for decision in seen],
        previous=[decision.previous for decision in seen],
        labels=[spelling[label.text] for label in labels],
        weights=np.array([label.weight for label in labels], np.float32),
        senses=np.stack([decision.arrays["proprioception"] for decision in seen]),
        looks=rows,
    )


def _past(decision: Decision) -> list[str]:
    """Ids of the earlier decisions whose pictures were shown with this one, oldest first."""
    return [f"{decision.episode}-{index}" for index in decision.past]


def _shown(ids: Iterable[str], store: Store) -> dict[str, NDArray[np.uint8]]:
    """The pictures of decisions by their ids; those that never arrived are missing."""
    shown = {}
    for id_ in dict.fromkeys(ids):
        with suppress(RefusedError):
            shown[id_] = np.array(next(iter(store.decisions([id_]))).arrays["images"])
    return shown


def agreed(policy: HighLevel, labels: Sequence[Label], store: Store, asked: Spelling) -> list[bool]:
    """Whether each label is what a policy proposes first.

    asked: what a phrase asks for, so that another wording of the same is no miss.
    """
    seen = store.decisions(label.decision for label in labels)
    return [
        asked(policy.propose(observation_of(decision), past_of(decision, store))[0].goal.text)
        == asked(label.text)
        for label, decision in zip(labels, seen, strict=True)
    ]


def known(policy: HighLevel, demonstrated: Examples) -> float | None:
    """The share of demonstrated decisions that a policy's bank head takes rightly."""
    if not len(demonstrated):
        return None
    return agreement(policy.net, policy.bank, demonstrated).bank


def past_of(decision: Decision, store: Store) -> list[NDArray[np.uint8] | None]:
    """The earlier pictures that the high level was shown, oldest first.

    None: one that never arrived. It keeps its place, as in `gather`: without it the others would
    pass for later ones than they were.
    """
    names = _past(decision)
    shown = _shown(names, store)
    return [shown.get(name) for name in names]


def observation_of(decision: Decision) -> Observation:
    """What the high level saw when it took a decision; arrays of its own, as torch wants them."""
    return Observation(
        step=decision.step,
        prompt=decision.prompt,
        previous=decision.previous,
        arrays={name: np.array(array) for name, array in decision.arrays.items()},
    )
