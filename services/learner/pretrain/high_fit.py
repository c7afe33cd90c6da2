"""Trains the base of the high level on the demonstrations, with a witness that learning alone has.

The witness must tell from the network's slots where each object is; that makes the eyes see
objects and not only backgrounds. It is thrown away afterwards.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn import functional as F

from services.learner.pretrain.demonstrate import Demonstrations
from shared.goals.language.bank import PhraseBank
from shared.goals.language.encoder import shared_encoder
from shared.policies.fit import FitSettings, Fitter, Source, vary
from shared.policies.high_net import SIGHT, SLOTS, HighLevelNet
from shared.policies.precision import autocast

STATUSES = 4
WITNESS_WEIGHT = 0.5


@dataclass(frozen=True)
class Fitted:
    """agreement: share of the last decisions in which the label came first.
    status: share of objects whose whereabouts the witness told."""

    agreement: float
    status: float


class Witness(nn.Module):
    """From each slot: on the table, in a hand, on the plate or in the bin; and where."""

    def __init__(self) -> None:
        super().__init__()
        self.status = nn.Linear(SIGHT, STATUSES)
        self.position = nn.Linear(SIGHT, 3)

    def loss(self, slots: Tensor, status: Tensor, positions: Tensor) -> Tensor:
        """slots [B, O, SIGHT]; status [B, O]; positions [B, O, 3] in m."""
        told = F.cross_entropy(self.status(slots).flatten(0, 1), status.flatten())
        off = F.smooth_l1_loss(self.position(slots), positions * 5, beta=0.2)
        return told + 4.0 * off


def fit_high(
    net: HighLevelNet,
    bank: PhraseBank,
    lessons: Demonstrations,
    settings: FitSettings,
    progress: Callable[[int, int, float], bool],
) -> Fitted:
    """Train `net` in place on demonstrations alone.

    progress: told updates done, updates in all and the loss; False stops early.
    """
    torch.manual_seed(settings.seed)
    rng = np.random.default_rng(settings.seed)
    source = Source(lessons.examples, settings.batch, bank, shared_encoder(), net.history)
    witness, phrases = Witness(), torch.tensor(bank.vectors)
    fitter = Fitter(net, settings, list(witness.parameters()))
    right = known = recent = 0.0
    for step in range(settings.steps):
        rows = source.choose(rng)
        batch = source.at(rows)
        question = vary(batch.question, settings, rng)
        status = torch.from_numpy(lessons.status[rows])
        with autocast(settings.half):
            slots = net.see(question.images).float()
            meaning = net.decide(slots, net.wish(question.prompts), question.previous)
        logits = net.scores(meaning, phrases)
        said = F.cross_entropy(logits, batch.labels)
        seen = witness.loss(slots, status, torch.from_numpy(lessons.positions[rows]))
        witness.zero_grad()
        fitter.update(said + WITNESS_WEIGHT * seen, step)
        fresh = max(0.02, 1.0 / (step + 1))
        right += ((logits.argmax(-1) == batch.labels).float().mean().item() - right) * fresh
        told = (witness.status(slots).argmax(-1) == status).float().mean().item()
        known += (told - known) * fresh
        recent += (said.item() - recent) * fresh
        if not progress(step + 1, settings.steps, recent):
            break
    fitter.finish()
    assert lessons.status.shape[1] == SLOTS
    return Fitted(right, known)


def agreement(net: HighLevelNet, bank: PhraseBank, lessons: Demonstrations) -> float:
    """Share of decisions whose label is the first choice, without any variation."""
    source = Source(lessons.examples, 1, bank, shared_encoder(), net.history)
    phrases, hits = torch.tensor(bank.vectors), 0
    with torch.inference_mode():
        for rows in np.array_split(
            np.arange(len(lessons.examples)), 1 + len(lessons.examples) // 256
        ):
            batch = source.at(rows)
            logits = net.scores(net(batch.question), phrases)
            hits += int((logits.argmax(-1) == batch.labels).sum())
    return hits / len(lessons.examples)
