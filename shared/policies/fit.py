"""Fine-tunes the high level on demonstrations and corrections: the learning of each round.

Warm start, a fresh optimizer, and a fixed share of corrections in each batch, whichever round
they come from. Both heads learn from the same labels. The same seed on the same machine gives the
same weights.

Source: Shi et al. 2024 (arXiv 2403.12910), whose share is .1 and of the last round only; cf.
Liu et al. 2023 (Sirius, arXiv 2211.08416), whose interventions have a share of .5.
"""

import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor
from torch.nn import functional as F

from shared.errors import PolicyError
from shared.goals.language.bank import PhraseBank
from shared.goals.language.encoder import Encoder, shared_encoder
from shared.policies.examples import Examples
from shared.policies.fitter import FitSettings, Fitter, Mean, keep, resumed
from shared.policies.high_net import HighLevelNet
from shared.policies.precision import autocast, pixel_type
from shared.policies.sources import Source, merge
from shared.policies.tones import tones_of

Progress = Callable[[int, int, float], bool]
ASKED = 256
"""At most about so many decisions are asked about at once."""
KEPT_UPDATES = 50
"""From one save of a fit under way to the next: some seconds."""
TEXT_WEIGHT = 0.3
"""Of the text head's loss, a sum over words, beside the bank's."""


class FitReport(NamedTuple):
    """How a fit went.

    steps: updates made. finished: not stopped early. loss: of the bank's head, mean over the last
    updates. agreement: share of decisions of the last updates whose label was its first choice.
    text_loss: of the text head, in nats a phrase.
    """

    steps: int
    finished: bool
    loss: float
    agreement: float
    seconds: float
    text_loss: float


def _carry_on(step: int, steps: int, loss: float) -> bool:
    del step, steps, loss  # Unused.
    return True


def fit(
    net: HighLevelNet,
    bank: PhraseBank,
    demonstrations: Examples,
    corrections: Examples | None,
    settings: FitSettings,
    progress: Progress = _carry_on,
    encoder: Encoder | None = None,
    kept: Path | None = None,
) -> FitReport:
    """Train `net` on in place, and leave it with the average of its last weights.

    The text head takes in words of the bank that it didn't know.
    progress: told updates done, updates in all and the loss; False stops early.
    kept: file of what is under way; with it a fit that was cut off goes on where it was.

    Raises:
        PolicyError: there is nothing to learn from, or a label is not in the bank.
    """
    began, encoder = time.monotonic(), encoder or shared_encoder()
    sources = sources_of(demonstrations, corrections, settings, bank, encoder, net)
    net.text.learn(bank.phrases, encoder)
    sights = [*net.eyes.parameters(), *net.glance.parameters()]
    frozen, slow = (sights, []) if settings.frozen_encoder else ([], behind(net))
    for number, source in enumerate(sources if settings.frozen_encoder else ()):
        source.remember(net, settings, settings.seed + number)
    teacher, fitter = Teacher(net, bank), Fitter(net, settings, frozen=frozen, slow=slow)
    lessons, text, agreement = Mean(), Mean(), Mean()
    done = before = resumed(fitter, kept, (lessons, text, agreement))
    for done in range(before + 1, settings.steps + 1):
        rng = np.random.default_rng([settings.seed, done])
        batch = merge([source.draw(rng) for source in sources])
        question = batch.varied(settings, rng, pixel_type(settings.half))
        with autocast(settings.half):
            answer = net(question)
        said = teacher.judge(answer.meaning, answer.thought, batch.labels)
        fitter.update(said.bank + TEXT_WEIGHT * said.text, done - 1)
        text.add(said.text.item())
        agreement.add(said.right)
        lessons.add(said.bank.item())
        if kept and done % KEPT_UPDATES == 0:
            keep(fitter, done, kept, (lessons, text, agreement))
        if not progress(done, settings.steps, lessons.value):
            break
    fitter.finish()
    seconds = time.monotonic() - began
    finished = done == settings.steps
    return FitReport(done, finished, lessons.value, agreement.value, seconds, text.value)


def behind(net: HighLevelNet) -> list[torch.nn.Parameter]:
    """What the eyes' answers go through on their way to the meaning; the text head is beside it."""
    apart = {id(part) for of in (net.eyes, net.glance, net.text) for part in of.parameters()}
    return [part for part in net.parameters() if id(part) not in apart]


class Agreement(NamedTuple):
    """Share of examples whose label is the first choice of each head, without any variation."""

    bank: float
    text: float


def agreement(
    net: HighLevelNet, bank: PhraseBank, seen: Examples, encoder: Encoder | None = None
) -> Agreement:
    """How far both heads agree with the labels; the text head where its likeliest phrase is one.

    Raises:
        PolicyError: a label is not in the bank.
    """
    source = Source(seen, 1, bank, encoder or shared_encoder(), net)
    phrases, rows = torch.tensor(bank.vectors), net.text.rows(bank.phrases)
    hits = said = 0
    with torch.inference_mode():
        for part in np.array_split(np.arange(len(seen)), 1 + len(seen) // ASKED):
            batch = source.at(part)
            answer = net(batch.question())
            hits += int((net.scores(answer.meaning, phrases).argmax(-1) == batch.labels).sum())
            likely = torch.stack([_nats(net, answer.thought, row) for row in rows], -1)
            said += int((likely.argmin(-1) == batch.labels).sum())
    return Agreement(hits / len(seen), said / len(seen))


def _nats(net: HighLevelNet, thoughts: Tensor, row: Tensor) -> Tensor:
    """-log p of one phrase for each thought, [B]."""
    return net.text.nats(thoughts, row.expand(len(thoughts), -1))


class Said(NamedTuple):
    """bank, text: losses of the two heads. right: share in which the bank's first choice was."""

    bank: Tensor
    text: Tensor
    right: float


class Teacher:
    """Holds what both heads say against the labels."""

    def __init__(self, net: HighLevelNet, bank: PhraseBank) -> None:
        self._net, self._phrases = net, torch.tensor(bank.vectors)
        self._rows = net.text.rows(bank.phrases)

    def judge(self, meaning: Tensor, thought: Tensor, labels: Tensor) -> Said:
        """meaning [B, 384], thought [B, 256], labels [B]: rows of the bank."""
        logits = self._net.scores(meaning, self._phrases)
        right = (logits.argmax(-1) == labels).float().mean().item()
        text = self._net.text.loss(thought, self._rows[labels])
        return Said(F.cross_entropy(logits, labels), text, right)


def sources_of(
    demonstrations: Examples,
    corrections: Examples | None,
    settings: FitSettings,
    bank: PhraseBank,
    encoder: Encoder,
    net: HighLevelNet,
) -> list[Source]:
    """Where batches come from; without corrections, demonstrations alone.

    Raises:
        PolicyError: both are empty.
    """
    share = settings.correction_share if corrections else 0.0
    if not len(demonstrations):
        share = 1.0
    corrected = round(settings.batch * share)
    parts = ((demonstrations, settings.batch - corrected), (corrections, corrected))
    sources = [Source(part, count, bank, encoder, net) for part, count in parts if part and count]
    if not sources:
        raise PolicyError("there is nothing to learn from: no demonstrations, no corrections")
    if corrections and len(sources) == len(parts) and settings.retoned:
        sources[0].retone(tones_of(corrections.images), settings.retoned)
    return sources
