"""Weights between what a round learned and what the base knew."""

import copy

import torch

from services.learner.anchor import anchor
from shared.goals.language.encoder import shared_encoder
from shared.policies.checkpoint import bundled
from shared.policies.high_level import HighLevel


def test_weights_lie_between_and_new_words_begin_at_zero() -> None:
    base = HighLevel.load(bundled("high_level")).net
    net = copy.deepcopy(base)
    net.text.learn(["fetch the marmalade"], shared_encoder())
    known = len(base.text.own)
    with torch.no_grad():
        for weight in net.parameters():
            weight.add_(1.0)
    anchor(net, base, 0.75)
    before = {name: weight.detach() for name, weight in base.named_parameters()}
    for name, weight in net.named_parameters():
        old = before[name] if name != "text.own" else weight.new_zeros(weight.shape)
        if name == "text.own":
            old[:known] = before[name]
        torch.testing.assert_close(weight.detach(), old + 0.75)
    assert len(net.text.own) > known
