"""Stay near the base: after a round, weights between what it learned and what the base knew.

Source: Wortsman et al. 2022 (WiSE-FT, arXiv 2109.01903): a network that was tuned on one
distribution keeps more of what it knew of others if its weights are averaged with the old ones.
"""

import torch

from shared.policies.high_net import HighLevelNet


def anchor(net: HighLevelNet, base: HighLevelNet, own: float) -> None:
    """Move the weights of `net` in place: `own` of what it learned, the rest of the base's.

    Words that the base's text head never knew count as its zeros, from which they began.
    """
    before = {name: weight.detach() for name, weight in base.named_parameters()}
    with torch.no_grad():
        for name, weight in net.named_parameters():
            old = before[name]
            if old.shape != weight.shape:
                old = torch.cat([old, torch.zeros_like(weight[len(old) :])])
            weight.lerp_(old, 1.0 - own)
