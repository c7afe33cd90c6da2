"""The text head: words in, the same words out, with probabilities that are right."""

import itertools

import pytest
import torch

from shared.errors import PolicyError
from shared.goals.language.encoder import shared_encoder
from shared.policies.heads import MOST_WORDS, THOUGHT, TextHead

PHRASES = ("put it down", "put it away", "wait")


def head(*phrases: str) -> TextHead:
    torch.manual_seed(0)
    made = TextHead()
    made.learn(phrases or PHRASES, shared_encoder())
    return made.eval()


def taught() -> tuple[TextHead, torch.Tensor]:
    """A head that says one phrase for each of three thoughts."""
    made, thoughts = head(), torch.eye(3, THOUGHT) * 3
    rows = made.rows(PHRASES)
    learner = torch.optim.Adam(made.parameters(), lr=2e-3)
    for _ in range(80):
        learner.zero_grad()
        made.loss(thoughts, rows).backward()  # type: ignore[no-untyped-call]
        learner.step()
    return made, thoughts


def test_each_thought_is_said_as_it_was_taught() -> None:
    made, thoughts = taught()
    with torch.inference_mode():
        said = [made.phrases(thought[None]) for thought in thoughts]
    assert [found[0][0] for found in said] == [*PHRASES]
    assert all(found[0][1] > 0.8 for found in said)


def test_a_phrase_has_the_probability_of_its_words() -> None:
    made, thought = head(), torch.ones(1, THOUGHT)
    with torch.inference_mode():
        found = dict(made.phrases(thought))
        for phrase, share in found.items():
            nats = made.nats(thought, made.rows([phrase]))
            assert share == pytest.approx(float((-nats.double()).exp()), rel=1e-3)


def test_the_likeliest_phrases_are_found() -> None:
    made, thought = head("a b", "c"), torch.ones(1, THOUGHT)
    texts = [
        " ".join(words)
        for length in (1, 2)
        for words in itertools.product(made.words, repeat=length)
    ]
    with torch.inference_mode():
        nats = torch.cat([made.nats(thought, made.rows([text])) for text in texts])
        best = made.phrases(thought)
    assert best[0][1] >= float((-nats).exp().max()) * (1 - 1e-4)
    assert [share for _, share in best] == sorted((s for _, s in best), reverse=True)


def test_new_words_leave_the_old_ones_as_they_were() -> None:
    made, thought = head(), torch.ones(1, THOUGHT)
    with torch.inference_mode():
        before, words = made.nats(thought, made.rows(["put it"])), made.words
    vectors, own = made.vectors.clone(), made.own.detach().clone()
    made.learn(["put it on the plate"], shared_encoder())
    assert made.words == (*words, "on", "the", "plate")
    assert torch.equal(made.vectors[: len(words)], vectors)
    assert torch.equal(made.own[: len(words) + 1], own)
    with torch.inference_mode():
        assert float(made.nats(thought, made.rows(["put it"]))) > float(before)


def test_words_that_it_does_not_know_are_named() -> None:
    with pytest.raises(PolicyError, match="does not know: banana"):
        head().rows(["put it banana"])
    with pytest.raises(PolicyError, match=f"at most {MOST_WORDS} words"):
        head().rows(["wait " * MOST_WORDS + "wait"])
