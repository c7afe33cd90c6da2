"""What a round trains on, byte by byte."""

import random

from hypothesis import given, settings
from hypothesis import strategies as st

from services.learner.labels.aggregate import LabelSettings, derive
from services.learner.labels.spell import canonical
from services.learner.store.memory import MemoryStore
from services.learner.store.store import Manifest
from services.learner.train import gather
from shared.messages.message import Message
from shared.policies.examples import Examples
from tests.unit.learner.records import (
    CHEESE,
    HAM,
    LOW,
    TOAST,
    correction,
    decision,
    episode,
    receipt,
    ruling,
)


def happenings() -> list[Message]:
    """Two episodes: an override, a relabel, a retraction, an alias; histories differ in length."""
    kept: list[Message] = [ruling("r-1", verb="alias", phrase=TOAST, means=CHEESE)]
    for name in ("e-1", "e-2"):
        for number, step in enumerate(range(0, 100, 20)):
            past = tuple(range(max(0, number - 2), number))
            previous = ("wait",) * min(number, 3)
            kept.append(decision(name, step, id=f"{name}-{number}", past=past, previous=previous))
        kept.append(correction(f"{name}-a", TOAST, episode=name, decision=f"{name}-2"))
        kept.append(receipt(f"{name}-a", 40, episode=name))
        span = {"first_step": 0, "end_step": 30, "created_ns": 5}
        kept.append(correction(f"{name}-b", HAM, kind="relabel", episode=name, **span))
        kept.append(episode(name))
    kept.append(correction("gone", kind="retract", target="e-2-b", episode="e-2", created_ns=9))
    return kept


def gathered(messages: list[Message]) -> Examples:
    store = MemoryStore()
    for number, message in enumerate(messages):
        store.add(message, number)  # type: ignore[arg-type]
    manifest = Manifest(marks=store.survey(Manifest()).marks)
    labels = derive(store.history(manifest), LabelSettings(), LOW)
    spelling = {canonical(phrase): phrase for phrase in (CHEESE, HAM, TOAST)}
    return gather(labels, spelling, store)


def as_bytes(examples: Examples) -> list[object]:
    arrays = (examples.images, examples.weights, examples.senses, examples.looks)
    words = (examples.prompts, examples.previous, examples.labels)
    return [*(None if one is None else one.tobytes() for one in arrays), *map(list, words)]


@settings(max_examples=15, deadline=None)
@given(st.randoms(use_true_random=False))
def test_the_same_manifest_gives_the_same_bytes_in_whatever_order_things_arrived(
    order: random.Random,
) -> None:
    messages = happenings()
    expected = as_bytes(gathered(messages))
    order.shuffle(messages)
    assert as_bytes(gathered(messages)) == expected


def test_a_history_is_as_the_high_level_saw_it_and_padded_where_it_saw_less() -> None:
    examples = gathered(happenings())
    assert examples.labels == [HAM, HAM, *[CHEESE] * 3, *[CHEESE] * 3]
    assert examples.previous[:3] == [(), ("wait",), ("wait", "wait")]
    assert examples.looks is not None
    assert examples.looks.shape == (8, 3)
    assert examples.looks[0].tolist()[:2] == [-1, -1]
    assert examples.looks[1].tolist()[0] == -1
    shades = examples.images[examples.looks[2], 0, 0, 0, 0]
    assert shades.tolist() == [0, 20, 40]
