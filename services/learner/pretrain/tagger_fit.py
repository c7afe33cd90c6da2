"""Teaches the reader's tagger which part each word of drawn phrases plays."""

import copy
from collections.abc import Sequence

import numpy as np
import torch
from torch.nn import functional as F
from torch.nn.utils.rnn import pad_sequence

from shared.config import Settings
from shared.goals.family import Floats
from shared.policies.reader.phrase import PARTS
from shared.policies.reader.tagger import Tagger

NO_PART = -100
"""Where a phrase is shorter than the longest of its batch."""


class TaggerFitSettings(Settings):
    """epochs: passes over all phrases. batch: phrases an update. lr: peak of one cycle."""

    epochs: int = 8
    batch: int = 64
    lr: float = 2e-3
    weight_decay: float = 1e-2


def fit_tagger(
    states: Sequence[Floats],
    parts: Sequence[tuple[int, ...]],
    settings: TaggerFitSettings,
    seed: int,
    start: Tagger | None = None,
) -> Tagger:
    """A tagger of phrases whose words have these states [w, S] and parts [w].

    start: goes on with what this one knows, which stays as it is.
    """
    torch.manual_seed(seed)
    rng = np.random.default_rng(seed)
    every = np.concatenate(states)
    tagger = _fresh(every) if start is None else copy.deepcopy(start).train()
    tagger.requires_grad_(True)
    x = [torch.from_numpy(one) for one in states]
    y = [torch.tensor(one) for one in parts]
    updates = settings.epochs * -(-len(x) // settings.batch)
    optimizer = torch.optim.AdamW(
        tagger.parameters(), lr=settings.lr, weight_decay=settings.weight_decay
    )
    cycle = torch.optim.lr_scheduler.OneCycleLR(optimizer, settings.lr, total_steps=updates)
    for _ in range(settings.epochs):
        order = rng.permutation(len(x))
        for first in range(0, len(x), settings.batch):
            rows = order[first : first + settings.batch]
            right = pad_sequence([y[row] for row in rows], batch_first=True, padding_value=NO_PART)
            told = tagger([x[row] for row in rows]).reshape(-1, len(PARTS))
            loss = F.cross_entropy(told, right.reshape(-1), ignore_index=NO_PART)
            optimizer.zero_grad()
            loss.backward()  # type: ignore[no-untyped-call]
            optimizer.step()
            cycle.step()
    return tagger.eval().requires_grad_(False)


def _fresh(states: Floats) -> Tagger:
    """One that knows nothing. states: [N, S] of words."""
    return Tagger(torch.from_numpy(states.mean(0)), torch.from_numpy(states.std(0) + 1e-6))
