"""The arms: equal in size, each learns, and those without words learn nothing from words."""

import numpy as np
import pytest
import torch

from services.learner.baselines import fit
from services.learner.baselines.net import build
from services.learner.baselines.scale import ARMS
from services.learner.baselines.work import fresh
from shared.errors import PolicyError
from shared.policies.checkpoint import sha256_tensors
from shared.policies.low_level import as_tensors
from tests.unit.baselines.taught import SETTINGS, begun, few, relabelled, teaching


def weights(fit):
    fit.finish()
    return sha256_tensors(as_tensors(fit.pair))


def test_the_arms_have_equally_many_parameters():
    counts = [fresh(arm, 0, teaching()).learned() for arm in ARMS]
    assert max(counts) <= 1.1 * min(counts)


def test_the_arms_of_one_seed_begin_with_the_same_trunk_and_mover():
    pairs = [fresh(arm, 3, teaching()) for arm in ARMS]
    for part in ("trunk", "mover"):
        assert len({sha256_tensors(as_tensors(getattr(pair, part))) for pair in pairs}) == 1


@pytest.mark.parametrize("arm", ARMS)
def test_the_losses_of_every_arm_fall_and_all_its_parameters_learn(arm):
    started = begun(arm, few(), SETTINGS.model_copy(update={"lr": 3e-3}))
    first, last = started.run(1), started.run(14)
    assert last.moved < 0.95 * first.moved
    assert (last.goal < first.goal) if started.pair.labelled else (first.goal == last.goal == 0)
    idle = [
        name
        for name, part in started.pair.named_parameters()
        if part.requires_grad and part.grad is None
    ]
    assert idle == []


@pytest.mark.parametrize("arm", ARMS)
def test_other_labels_change_only_arms_that_are_told_them(arm):
    one, other = begun(arm), begun(arm, relabelled(teaching()))
    for started in (one, other):
        started.run(1)
    assert (weights(one) == weights(other)) is not one.pair.labelled


def test_no_action_teaches_the_trunk_of_a_hierarchy(monkeypatch):
    monkeypatch.setattr(fit, "chunk_loss", lambda *_: torch.zeros(()))
    without = begun("hierarchy")
    without.run(1)
    trunk = [part.grad.clone() for part in without.pair.trunk.parameters() if part.requires_grad]
    monkeypatch.undo()
    whole = begun("hierarchy")
    whole.run(1)
    with_it = [part.grad for part in whole.pair.trunk.parameters() if part.requires_grad]
    # Clipping scales all gradients together, so their directions are compared.
    one, other = (torch.cat([part.flatten() for part in parts]) for parts in (trunk, with_it))
    assert torch.cosine_similarity(one, other, 0) > 0.9999


def test_a_stopped_fit_goes_on_as_if_nothing_had_been(tmp_path):
    whole = begun("latent")
    whole.run(4)
    file = tmp_path / "kept.safetensors"
    begun("latent", kept=file).run(2)
    again = begun("latent", kept=file)
    assert again.done == 2
    again.run(4)
    assert weights(whole) == weights(again)


def test_rows_are_drawn_from_the_window_of_their_look():
    taught = teaching()
    looks, steps = fit.lessons_of(taught, "chain")
    rows = fit.LookRows(looks, steps, fresh("chain", 0, taught).mover.geometry, 6)
    some = np.arange(len(looks))
    lot = rows.draw(some, np.random.default_rng(0))
    empty = np.diff(looks.windows)[:, 0] == 0
    weighed = (lot.weights.sum(1) > 0).reshape(-1, 6).any(1).numpy()
    assert empty.any()
    assert not weighed[empty].any()
    assert weighed[~empty].mean() > 0.9


def test_other_tensors_are_no_baseline():
    tensors = as_tensors(fresh("flat", 0, teaching()))
    with pytest.raises(PolicyError, match="no arm 'tall': there are hierarchy, chain"):
        build({"arm": "tall"}, tensors)
    with pytest.raises(PolicyError, match="no baseline"):
        build({"arm": "chain"}, tensors)
