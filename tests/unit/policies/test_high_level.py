"""The high level: proposals, versions, and fine-tuning that really learns."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from shared.errors import PolicyError
from shared.goals.language.bank import PhraseBank
from shared.goals.language.encoder import shared_encoder
from shared.messages.decision import entropy
from shared.messages.policy import PolicyAnnouncement, TensorRef, Version
from shared.policies import examples as many
from shared.policies.checkpoint import sha256_tensors
from shared.policies.examples import Examples
from shared.policies.fit import FitReport, fit, sources_of
from shared.policies.fitter import FitSettings
from shared.policies.high_level import Head, HighLevel, build_net
from shared.policies.high_net import HighLevelNet
from shared.policies.sources import Source
from shared.policies.variation import Variation
from tests.unit.policies.scenes import COMMANDS, coloured, moving, observation
from tests.unit.policies.test_checkpoint import card

QUICK = FitSettings(steps=40, batch=24, lr=1e-3, half=False)


def high_level(seed: int = 0, head: Head = "bank") -> HighLevel:
    torch.manual_seed(seed)
    net, bank = HighLevelNet(), PhraseBank.of(COMMANDS)
    net.text.learn(bank.phrases, shared_encoder())
    return HighLevel(net, bank, Version(1, 0), head=head)


def agreement(policy: HighLevel, examples: Examples) -> float:
    hits = 0
    for row, label in enumerate(examples.labels):
        *earlier, now = examples.looks[row]
        past = [examples.images[moment] for moment in earlier if moment >= 0]
        seen = observation(
            examples.images[now],
            examples.previous[row],
            examples.prompts[row],
            examples.senses[row],
        )
        hits += policy.propose(seen, past)[0].goal.text == label
    return hits / len(examples)


def learn(policy: HighLevel, corrections: Examples | None, settings: FitSettings) -> FitReport:
    return fit(policy.net, policy.bank, coloured(60), corrections, settings)


def announcement(policy: HighLevel) -> PolicyAnnouncement:
    refs = [
        TensorRef(
            name=name,
            sha256="0" * 64,
            dtype=str(value.dtype),
            shape=value.shape,
            size_bytes=value.nbytes,
        )
        for name, value in policy.tensors().items()
    ]
    return PolicyAnnouncement(
        version=Version(1, 4),
        learner="one",
        created_ns=1,
        tensors=tuple(refs),
        bank=policy.bank.phrases,
        low_level_sha256="0" * 64,
        settings=policy.settings(),
    )


def test_all_of_the_bank_is_proposed_best_first() -> None:
    proposals = high_level().propose(observation(coloured(1).images[0]))
    scores = [proposal.score for proposal in proposals]
    assert {proposal.goal.text for proposal in proposals} == set(COMMANDS)
    assert scores == sorted(scores, reverse=True)
    assert sum(scores) == pytest.approx(1.0)


def test_a_robot_with_other_senses_is_told_so() -> None:
    seen = observation(coloured(1).images[0], feels=np.zeros(7, np.float32))
    with pytest.raises(PolicyError, match="feels 22 numbers"):
        high_level().propose(seen)


def test_a_version_is_rebuilt_from_its_announcement_and_tensors() -> None:
    policy = high_level()
    built = HighLevel.build(announcement(policy), policy.tensors())
    seen = observation(coloured(1).images[0], ("wait",))
    assert built.version == Version(1, 4)
    assert built.propose(seen) == policy.propose(seen)


def test_tensors_that_were_not_announced_are_refused() -> None:
    policy = high_level()
    tensors = policy.tensors()
    del tensors["name"]
    with pytest.raises(PolicyError, match="announces tensors"):
        HighLevel.build(announcement(policy), tensors)


def test_settings_of_another_network_are_refused() -> None:
    policy = high_level()
    other = announcement(policy).model_copy(
        update={"settings": {"history": 2, "looks": 4, "words": ""}}
    )
    with pytest.raises(PolicyError, match="no high level"):
        HighLevel.build(other, policy.tensors())


def test_both_heads_learn_what_corrections_say() -> None:
    policy, fresh = high_level(), coloured(40, seed=5)
    report = learn(policy, coloured(40, seed=1), QUICK)
    assert report.finished
    assert report.steps == QUICK.steps
    assert agreement(policy, fresh) > 0.9
    assert agreement(HighLevel(policy.net, policy.bank, policy.version, head="text"), fresh) > 0.9


def test_what_the_arms_feel_and_the_prompt_says_is_learned() -> None:
    kinds = np.random.default_rng(0).integers(0, 3, 60)
    felt = replace(
        coloured(60),
        images=np.zeros((60, 2, 64, 64, 3), np.uint8),
        labels=[COMMANDS[k] for k in kinds],
    )
    felt.senses[:, 3] = kinds - 1.0
    asked = replace(felt, senses=np.zeros((60, 22), np.float32))
    asked.prompts[:] = [("make a sandwich", "no sandwich", "a sandwich, no ham")[k] for k in kinds]
    for shown in (felt, asked):
        policy = high_level()
        fit(policy.net, policy.bank, shown, None, QUICK)
        assert agreement(policy, shown.take(range(20))) > 0.9


def test_earlier_looks_tell_what_moves() -> None:
    policy = high_level()
    settings = QUICK.model_copy(update={"steps": 60, "look_dropout": 0.0, "brightness": 0.0})
    fit(policy.net, policy.bank, moving(60), None, settings)
    assert agreement(policy, moving(20, seed=2)) > 0.8


def test_words_that_people_bring_in_are_said_by_the_text_head() -> None:
    policy = high_level(head="text")
    named = coloured(40)
    named.labels[:] = ["grab the cheddar" if "cheese" in label else label for label in named.labels]
    bank = policy.bank.add("grab the cheddar")
    fit(policy.net, bank, named, None, QUICK)
    taught = HighLevel(policy.net, bank, policy.version, head="text")
    assert agreement(taught, named.take(range(20))) > 0.9
    again = build_net(taught.settings(), taught.tensors())
    assert again.text.words == policy.net.text.words
    assert "cheddar" in again.text.words


def test_the_text_head_makes_phrases_with_probabilities() -> None:
    proposals = high_level(head="text").propose(observation(coloured(1).images[0]))
    scores = [proposal.score for proposal in proposals]
    assert len({proposal.goal.text for proposal in proposals}) == len(proposals) > 1
    assert scores == sorted(scores, reverse=True)
    assert sum(scores) <= 1.0 + 1e-9
    assert entropy(proposals) > 0


def test_the_same_seed_gives_the_same_weights_and_another_one_others() -> None:
    short = QUICK.model_copy(update={"steps": 3})
    hashes = []
    for seed in (0, 0, 1):
        policy = high_level()
        learn(policy, coloured(20, seed=1), short.model_copy(update={"seed": seed}))
        hashes.append(sha256_tensors(policy.tensors()))
    assert hashes[0] == hashes[1] != hashes[2]


def test_a_fit_can_be_stopped_early() -> None:
    told: list[tuple[int, int]] = []

    def stop_at_two(step: int, steps: int, loss: float) -> bool:
        told.append((step, steps))
        assert np.isfinite(loss)
        return step < 2

    policy = high_level()
    report = fit(policy.net, policy.bank, coloured(20), None, QUICK, stop_at_two)
    assert told == [(1, 40), (2, 40)]
    assert not report.finished
    assert report.steps == 2


def test_frozen_eyes_stay_as_they_are() -> None:
    policy = high_level()
    before = policy.tensors()
    learn(policy, None, QUICK.model_copy(update={"steps": 2, "frozen_encoder": True}))
    after = policy.tensors()
    changed = {name for name in before if not np.array_equal(before[name], after[name])}
    assert changed
    assert not any(name.startswith(("eyes", "glance.")) for name in changed)


def test_what_frozen_eyes_remember_is_what_they_would_see_again() -> None:
    policy, still = high_level(), Variation(shift_px=0, brightness=0, tint=0, noise=0)
    shown = moving(12)
    source = Source(shown, 5, policy.bank, shared_encoder(), policy.net)
    source.remember(policy.net, still, 0)
    batch = source.draw(np.random.default_rng(3))
    assert batch.sights is not None
    question = batch.question()
    with torch.no_grad():
        again = policy.net.look(question.images), policy.net.glimpse(question.glimpses)
    seen = torch.from_numpy(batch.seen)
    assert torch.allclose(batch.sights.eyes, again[0], atol=1e-5)
    assert torch.allclose(batch.sights.glances[seen], again[1][seen], atol=1e-5)
    with torch.no_grad():
        blind = question._replace(images=question.images * 0, sights=batch.sights)
        plain = policy.net(question._replace(sights=None)).meaning
        assert torch.allclose(policy.net(blind).meaning, plain, atol=1e-4)


def test_with_frozen_eyes_a_fit_learns_what_is_behind_them() -> None:
    policy = high_level()
    learn(policy, None, QUICK)
    seen = coloured(60)
    names = sorted(set(seen.labels))
    other = dict(zip(names, [*names[1:], names[0]], strict=True))
    exchanged = replace(seen, labels=[other[label] for label in seen.labels])
    assert agreement(policy, exchanged) < 0.2
    settings = QUICK.model_copy(update={"frozen_encoder": True, "steps": 60})
    fit(policy.net, policy.bank, exchanged, None, settings)
    assert agreement(policy, exchanged) > 0.9


@pytest.mark.parametrize(("share", "counts"), [(0.1, [58, 6]), (0.3, [45, 19]), (0.5, [32, 32])])
def test_corrections_have_their_share_of_each_batch(share: float, counts: list[int]) -> None:
    policy = high_level()
    settings = FitSettings(batch=64, correction_share=share)
    parts = (coloured(60), coloured(9), settings, policy.bank, shared_encoder(), policy.net)
    assert [source.count for source in sources_of(*parts)] == counts


def test_a_label_outside_the_bank_is_refused() -> None:
    policy, wrong = high_level(), coloured(4)
    wrong.labels[2] = "wave"
    with pytest.raises(PolicyError, match="does not hold: wave"):
        fit(policy.net, policy.bank, wrong, None, QUICK)


def test_nothing_to_learn_from_is_refused() -> None:
    policy, none = high_level(), coloured(3).take([])
    with pytest.raises(PolicyError, match="nothing to learn from"):
        fit(policy.net, policy.bank, none, None, QUICK)
    weightless = coloured(3)
    weightless.weights[:] = 0
    with pytest.raises(PolicyError, match="weight 0"):
        fit(policy.net, policy.bank, weightless, None, QUICK)


def test_examples_survive_the_disk_but_for_a_little_jpeg(tmp_path: Path) -> None:
    examples = coloured(70)
    many.save(tmp_path, examples, card())
    again = many.load(tmp_path)
    assert again.prompts == examples.prompts
    assert again.previous == examples.previous
    assert again.labels == examples.labels
    assert np.array_equal(again.weights, examples.weights)
    assert np.array_equal(again.senses, examples.senses)
    assert np.array_equal(again.looks, examples.looks)
    off = np.abs(again.images.astype(int) - examples.images.astype(int))
    assert again.images.shape == examples.images.shape
    assert off.mean() < 16


def test_examples_of_uneven_lengths_are_refused() -> None:
    with pytest.raises(PolicyError, match="different lengths"):
        replace(coloured(2), prompts=["a"])


def test_examples_that_look_at_what_is_not_there_are_refused() -> None:
    with pytest.raises(PolicyError, match="not among their 2"):
        replace(coloured(2), looks=np.array([[-1, 0], [0, 2]]))


def test_taken_examples_keep_the_moments_that_they_looked_at() -> None:
    examples = moving(5)
    few = many.join([examples.take([3, 1]), coloured(1), examples.take([4])])
    assert len(few.images) == 2 * 2 + 1 + 2
    for row, whence in enumerate([3, 1, None, 4]):
        if whence is not None:
            shown = examples.images[examples.looks[whence]]
            assert np.array_equal(few.images[few.looks[row]], shown)
    assert few.looks[2].tolist() == [-1, 4]
