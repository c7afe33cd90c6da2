"""Trains the base of the high level on the demonstrations, with witnesses that learning alone has.

One must tell from the network's slots where each body is, one from its wishes what the prompt
means for each thing; that makes the eyes see things and the ears hear words. They are thrown away
afterwards.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.nn import functional as F

from services.learner.pretrain.demonstrate import ABSENT, STATUSES, Demonstrations
from services.learner.pretrain.meanings import Meanings, Prompts, Reader, meanings_of
from shared.goals.language.bank import PhraseBank
from shared.goals.language.encoder import shared_encoder
from shared.policies.fit import TEXT_WEIGHT, Teacher
from shared.policies.fitter import FitSettings, Fitter, Mean, keep, resumed
from shared.policies.high_net import SIGHT, HighLevelNet
from shared.policies.precision import autocast, pixel_type
from shared.policies.sources import Batch, Source, joined

SIGHT_WEIGHT, MEANING_WEIGHT = 0.5, 0.5
PROMPTS = 16
"""Prompts without pictures in each update."""
KEPT_UPDATES = 400
"""Updates from one save to the next: a stop loses about a minute."""


@dataclass(frozen=True)
class Fitted:
    """Shares over the last updates. agreement: of decisions whose label came first.
    status: of bodies whose whereabouts were told. meaning: of things whose wish was told."""

    agreement: float
    status: float
    meaning: float


class Witness(nn.Module):
    """From each slot: on the table, in a hand, and so on; and where."""

    def __init__(self) -> None:
        super().__init__()
        self.status = nn.Linear(SIGHT, len(STATUSES))
        self.position = nn.Linear(SIGHT, 3)

    def loss(self, slots: Tensor, status: Tensor, positions: Tensor) -> tuple[Tensor, float]:
        """The loss, and the share of statuses that were told.

        slots [B, O, SIGHT]; status [B, O]; positions [B, O, 3] in m, of no account where absent.
        """
        logits = self.status(slots)
        told = F.cross_entropy(logits.flatten(0, 1), status.flatten())
        there = (status != ABSENT)[..., None]
        off = F.smooth_l1_loss(
            self.position(slots) * there, positions * 5 * there, beta=0.2, reduction="sum"
        )
        right = (logits.argmax(-1) == status).float().mean().item()
        return told + 4.0 * off / (3 * there.sum()), right


class Lessons:
    """Demonstrations made ready, with what only training knows of them."""

    def __init__(self, lessons: Demonstrations, count: int, bank: PhraseBank, net: HighLevelNet):
        self.source = Source(lessons.examples, count, bank, shared_encoder(), net)
        self._status = torch.from_numpy(lessons.status)
        self._positions = torch.from_numpy(lessons.positions)
        prompts = sorted(set(lessons.examples.prompts))
        number = {prompt: row for row, prompt in enumerate(prompts)}
        self._prompt = torch.tensor([number[prompt] for prompt in lessons.examples.prompts])
        self._meanings = meanings_of(prompts)

    def draw(self, rng: np.random.Generator) -> tuple[Batch, Tensor, Tensor, Meanings]:
        """A batch; of each decision statuses, positions, and what its prompt means."""
        return self.at(self.source.choose(rng))

    def at(self, rows: NDArray[np.int64]) -> tuple[Batch, Tensor, Tensor, Meanings]:
        """The same of these rows."""
        truth = self._status[rows], self._positions[rows], self._meanings.at(self._prompt[rows])
        return self.source.at(rows), *truth


def fit_high(
    net: HighLevelNet,
    bank: PhraseBank,
    lessons: Demonstrations,
    settings: FitSettings,
    progress: Callable[[int, int, float], bool],
    prompts: int = 6000,
    kept: Path | None = None,
) -> Fitted:
    """Train `net` in place on demonstrations alone.

    progress: told updates done, updates in all and the loss; False stops early.
    prompts: how many are drawn to learn from without pictures.
    kept: file of what is under way; with it a fit that was stopped goes on where it was.
    """
    net.text.learn(bank.phrases, shared_encoder())
    torch.manual_seed(settings.seed)
    ready = Lessons(lessons, settings.batch, bank, net)
    more = Prompts(prompts, settings.seed, shared_encoder())
    sight, reader = Witness(), Reader()
    fitter = Fitter(net, settings, [*sight.parameters(), *reader.parameters()])
    teacher, lost = Teacher(net, bank), Mean(0.02)
    right, known, meant = Mean(0.02), Mean(0.02), Mean(0.02)
    for step in range(resumed(fitter, kept), settings.steps):
        rng = np.random.default_rng([settings.seed, step + 1])
        batch, status, positions, meanings = ready.draw(rng)
        extra, extra_meanings = more.draw(PROMPTS, rng)
        question = batch.varied(settings, rng, pixel_type(settings.half))
        with autocast(settings.half):
            slots = net.see(question.images)
            wishes = net.wish(joined((question.words, extra)))
            answer = net.decide(slots, wishes[: len(slots)], question)
        said = teacher.judge(answer.meaning, answer.thought, batch.labels)
        seen, found = sight.loss(slots.float(), status, positions)
        heard, understood = reader.loss(wishes, _both(meanings, extra_meanings))
        loss = said.bank + TEXT_WEIGHT * said.text
        fitter.update(loss + SIGHT_WEIGHT * seen + MEANING_WEIGHT * heard, step)
        for mean, value in ((right, said.right), (known, found), (meant, understood)):
            mean.add(value)
        if kept and (step + 1) % KEPT_UPDATES == 0:
            keep(fitter, step + 1, kept)
        if not progress(step + 1, settings.steps, lost.add(said.bank.item())):
            break
    fitter.finish()
    return Fitted(right.value, known.value, meant.value)


def _both(one: Meanings, other: Meanings) -> Meanings:
    return Meanings(*(torch.cat(parts) for parts in zip(one, other, strict=True)))
