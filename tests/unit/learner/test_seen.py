"""What a label shows the network is what the robot's high level was shown when it decided."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from services.learner.gather import gather, observation_of, past_of
from services.learner.labels.aggregate import Label, LabelSettings, derive
from services.learner.store.memory import MemoryStore
from services.learner.store.store import Manifest
from shared.goals.language.bank import PhraseBank
from shared.goals.language.encoder import shared_encoder
from shared.messages.correction import Kind
from shared.messages.decision import Decision
from shared.messages.observation import Observation
from shared.messages.policy import Version
from shared.policies.high_level import HighLevel
from shared.policies.high_net import HighLevelNet, Question
from shared.policies.sources import Source
from tests.unit.learner.records import episode
from tests.unit.rollout.fakes import EchoingLowLevel, SayingHighLevel, rollout_of, said

STEPS = 100
PHRASES = ("left", "right", "up", "something else")
SPELLING = dict(zip(PHRASES, PHRASES, strict=True))
SPEAKING = st.lists(
    st.tuples(
        st.integers(0, STEPS - 1),
        st.sampled_from((Kind.OVERRIDE, Kind.RELEASE)),
        st.sampled_from(("right", "up")),
        st.sampled_from((None, 7, 30)),
    ),
    max_size=5,
)
LOST = st.sets(st.integers(0, 12), max_size=4)


@pytest.fixture(scope="module")
def policy() -> HighLevel:
    torch.set_num_threads(1)
    torch.manual_seed(0)
    return HighLevel(HighLevelNet(), PhraseBank.of(PHRASES), Version(1, 0))


class Watched(NamedTuple):
    """An episode as its robot went through it, and the labels that a learner has of it.

    asked: what the high level was shown at each decision. lost: indices of the decisions that the
    learner never got.
    """

    decisions: list[Decision]
    asked: list[tuple[Observation, tuple[NDArray[np.uint8], ...]]]
    lost: frozenset[int]
    store: MemoryStore
    labels: tuple[Label, ...]

    def rows(self) -> Iterable[tuple[int, Decision]]:
        """Row of each label, with its decision."""
        by_id = {decision.id: decision for decision in self.decisions}
        return ((row, by_id[label.decision]) for row, label in enumerate(self.labels))


def watch(
    words: list[tuple[int, Kind, str, int | None]], lost: set[int], **rollout_settings: object
) -> Watched:
    """One episode in which these words are said at these steps, and endorsed where nobody spoke."""
    decisions, store, high_level = list[Decision](), MemoryStore(), SayingHighLevel("left", "right")
    rollout = rollout_of(
        high_level=high_level, decisions=decisions, max_steps=STEPS, **rollout_settings
    )
    for at, kind, text, hold_steps in sorted(words, key=lambda word: word[0]):
        while rollout.step < at:
            rollout.advance()
        override = kind is Kind.OVERRIDE
        word = said(kind, text if override else None, hold_steps=hold_steps if override else None)
        store.add(word, 1)
        store.add(rollout.correct(word), 1)
    while rollout.advance():
        pass
    store.add(said(Kind.ENDORSE, first_step=0, end_step=STEPS), 1)
    for decision in decisions:
        if decision.index not in lost:
            store.add(decision, 1)
    low = EchoingLowLevel.sha256
    store.add(episode("ep-1", task="pack", steps=STEPS, low_level_sha256=low), 1)
    manifest = Manifest(marks=store.survey(Manifest()).marks)
    labels = derive(store.history(manifest), LabelSettings(before_steps=3), low)
    asked = [*zip(high_level.seen, high_level.past, strict=True)]
    return Watched(decisions, asked, frozenset(lost), store, labels)


@settings(max_examples=25, deadline=None)
@given(SPEAKING, LOST, st.integers(1, 4), st.integers(1, 3), st.integers(0, 15), st.integers(0, 4))
def test_a_label_shows_what_the_robots_high_level_was_shown(
    policy: HighLevel,
    words: list[tuple[int, Kind, str, int | None]],
    lost: set[int],
    looks: int,
    look_every: int,
    latency_steps: int,
    history: int,
) -> None:
    watched = watch(
        words,
        lost,
        decision_steps=10,
        looks=looks,
        look_every=look_every,
        latency_steps=latency_steps,
        history=history,
    )
    if not watched.labels:
        return
    examples = gather(watched.labels, SPELLING, watched.store)
    source = Source(examples, 1, policy.bank, shared_encoder(), policy.net)
    for row, decision in watched.rows():
        observation, past = watched.asked[decision.index]
        assert examples.prompts[row] == observation.prompt
        assert examples.previous[row] == observation.previous
        np.testing.assert_array_equal(examples.senses[row], observation.arrays["proprioception"])
        here = [
            None if index in watched.lost else pictures
            for index, pictures in zip(decision.past, past, strict=True)
        ]
        shown = [*here, observation.arrays["images"]]
        rows = examples.looks[row]
        assert set(rows[: len(rows) - len(shown)]) <= {-1}
        for pictures, moment in zip(shown, rows[len(rows) - len(shown) :], strict=True):
            assert (moment == -1) == (pictures is None)
            if pictures is not None:
                np.testing.assert_array_equal(examples.images[moment], pictures)
        learned = source.at(np.array([row])).question()
        same(policy.question(observation, here), learned)
        same(policy.question(observation_of(decision), past_of(decision, watched.store)), learned)


def same(asked: Question, learned: Question) -> None:
    """What a network is asked while it decides and while it learns; what is masked is no matter."""
    seen = asked.seen
    assert torch.equal(seen, learned.seen)
    assert torch.equal(asked.images, learned.images)
    assert torch.equal(asked.glimpses[seen], learned.glimpses[seen])
    assert torch.equal(asked.senses, learned.senses)
    assert torch.equal(asked.previous, learned.previous)
    assert torch.equal(asked.words.there, learned.words.there)
    assert torch.equal(asked.words.states, learned.words.states)


def test_a_look_that_never_arrived_leaves_a_gap_and_moves_no_other(policy: HighLevel) -> None:
    watched = watch([], {3}, decision_steps=10)
    names = {label.decision: row for row, label in enumerate(watched.labels)}
    row, decision = names["ep-1-5"], watched.decisions[5]
    assert decision.past == (2, 3, 4)
    past = past_of(decision, watched.store)
    assert [None if one is None else int(one[0, 0, 0, 0]) for one in past] == [20, None, 40]
    examples = gather(watched.labels, SPELLING, watched.store)
    moments = examples.looks[row]
    assert moments[1] == -1
    assert examples.images[moments[[0, 2, 3]], 0, 0, 0, 0].tolist() == [20, 40, 50]
    question = policy.question(observation_of(decision), past)
    assert question.seen.tolist() == [[True, False, True, True]]
