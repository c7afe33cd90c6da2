"""Fine-tunes the high level on demonstrations and corrections: the learning of each round.

Warm start, a fresh optimizer, and a fixed share of corrections in each batch, whichever round
they come from. The same seed on the same machine gives the same weights.

Source: Shi et al. 2024 (arXiv 2403.12910), whose share is .1 and of the last round only; cf.
Liu et al. 2023 (Sirius, arXiv 2211.08416), whose interventions have a share of .5.
"""

import time
from collections.abc import Callable
from typing import Annotated, NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from pydantic import Field
from torch import Tensor
from torch.nn import functional as F

from shared.config import Settings
from shared.errors import PolicyError
from shared.goals.language.bank import PhraseBank
from shared.goals.language.encoder import Encoder, shared_encoder
from shared.policies.examples import Examples
from shared.policies.high_net import HighLevelNet, Question
from shared.policies.precision import autocast
from shared.policies.reading import forgetful, past_vectors, relit, shifted

Progress = Callable[[int, int, float], bool]
AVERAGE = 0.98
WARM_STEPS = 20


class FitSettings(Settings):
    """How a round learns.

    steps: updates. batch: decisions in each. lr: the highest learning rate, then down a cosine.
    correction_share: part of each batch that is drawn from the corrections.
    history_dropout: share of decisions that are shown without previous commands.
    shift_px, brightness, tint, noise: how pictures are varied; noise in levels of 0..255.
    frozen_encoder: leave the eyes as they are, and train only what is behind them.
    half: compute in bfloat16; None: where the processor is made for it.
    """

    steps: Annotated[int, Field(ge=1, le=1_000_000)] = 400
    batch: Annotated[int, Field(ge=1, le=4096)] = 64
    lr: Annotated[float, Field(gt=0, le=1)] = 1e-3
    weight_decay: Annotated[float, Field(ge=0, le=1)] = 1e-3
    correction_share: Annotated[float, Field(ge=0, le=1)] = 0.5
    history_dropout: Annotated[float, Field(ge=0, le=1)] = 0.2
    shift_px: Annotated[int, Field(ge=0, le=16)] = 3
    brightness: Annotated[float, Field(ge=0, le=1)] = 0.12
    tint: Annotated[float, Field(ge=0, le=1)] = 0.05
    noise: Annotated[float, Field(ge=0, le=64)] = 3.0
    frozen_encoder: bool = False
    half: bool | None = None
    seed: Annotated[int, Field(ge=0)] = 0


class FitReport(NamedTuple):
    """How a fit went.

    steps: updates made. finished: not stopped early. loss: mean over the last updates.
    agreement: share of decisions of the last updates whose label was the first choice.
    """

    steps: int
    finished: bool
    loss: float
    agreement: float
    seconds: float


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
) -> FitReport:
    """Train `net` on in place, and leave it with the average of its last weights.

    progress: told updates done, updates in all and the loss; False stops early.

    Raises:
        PolicyError: there is nothing to learn from, or a label is not in the bank.
    """
    began = time.monotonic()
    torch.manual_seed(settings.seed)
    rng = np.random.default_rng(settings.seed)
    sources = sources_of(
        demonstrations, corrections, settings, bank, encoder or shared_encoder(), net
    )
    fitter = Fitter(net, settings)
    phrases = torch.tensor(bank.vectors)
    loss = agreement = 0.0
    done = 0
    for done in range(1, settings.steps + 1):
        batch = merge([source.draw(rng) for source in sources])
        question = vary(batch.question, settings, rng)
        with autocast(settings.half):
            meaning = net(question)
        logits = net.scores(meaning, phrases)
        now = F.cross_entropy(logits, batch.labels)
        fitter.update(now, done - 1)
        fresh = max(0.03, 1.0 / done)
        loss += (now.item() - loss) * fresh
        agreement += ((logits.argmax(-1) == batch.labels).float().mean().item() - agreement) * fresh
        if not progress(done, settings.steps, loss):
            break
    fitter.finish()
    return FitReport(done, done == settings.steps, loss, agreement, time.monotonic() - began)


class Batch(NamedTuple):
    """A question and the rows of the bank that answer it, [B] int64."""

    question: Question
    labels: Tensor


class Source:
    """Examples that a fixed number of each batch is drawn from, by their weights."""

    def __init__(
        self, examples: Examples, count: int, bank: PhraseBank, encoder: Encoder, history: int
    ) -> None:
        total = float(examples.weights.sum())
        if total <= 0:
            raise PolicyError("there is nothing to learn from: all examples have weight 0")
        self.count = count
        self._sums: NDArray[np.float64] = np.cumsum(examples.weights, dtype=np.float64) / total
        self._images = examples.images
        self._prompts = encoder.embed(examples.prompts)
        self._previous = past_vectors(encoder, examples.previous, history)
        rows = {phrase: row for row, phrase in enumerate(bank.phrases)}
        unknown = sorted(set(examples.labels) - set(rows))
        if unknown:
            raise PolicyError(f"labels that the bank does not hold: {', '.join(unknown)}")
        self._labels = np.array([rows[label] for label in examples.labels], np.int64)

    def draw(self, rng: np.random.Generator) -> Batch:
        """`count` examples, with replacement."""
        return self.at(self.choose(rng))

    def choose(self, rng: np.random.Generator) -> NDArray[np.int64]:
        """Rows drawn by weight."""
        rows = np.searchsorted(self._sums, rng.random(self.count), side="right")
        return np.minimum(rows, len(self._sums) - 1)

    def at(self, rows: NDArray[np.int64]) -> Batch:
        """The examples of these rows."""
        arrays = self._images[rows], self._prompts[rows], self._previous[rows]
        question = Question(*(torch.from_numpy(array) for array in arrays))
        return Batch(question, torch.from_numpy(self._labels[rows]))


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
    sources = [
        Source(part, count, bank, encoder, net.history) for part, count in parts if part and count
    ]
    if not sources:
        raise PolicyError("there is nothing to learn from: no demonstrations, no corrections")
    return sources


def merge(batches: list[Batch]) -> Batch:
    """Batches one after another."""
    questions = [batch.question for batch in batches]
    question = Question(*(torch.cat(parts) for parts in zip(*questions, strict=True)))
    return Batch(question, torch.cat([batch.labels for batch in batches]))


def vary(question: Question, settings: FitSettings, rng: np.random.Generator) -> Question:
    """The same question, seen a little differently."""
    images = shifted(question.images, settings.shift_px, rng)
    pixels = relit(images.float(), settings.brightness, settings.tint, settings.noise, rng)
    past = forgetful(question.previous, settings.history_dropout, rng)
    return Question(pixels, question.prompts, past)


class Fitter:
    """Optimizer, learning rate and averaged weights of one fit."""

    def __init__(
        self,
        net: HighLevelNet,
        settings: FitSettings,
        others: list[torch.nn.Parameter] | None = None,
    ) -> None:
        frozen = {id(part) for part in net.eyes.parameters()} if settings.frozen_encoder else set()
        self._own = [part for part in net.parameters() if id(part) not in frozen]
        self._average = [part.detach().clone() for part in self._own]
        self._trained = self._own + (others or [])
        self._optimizer = torch.optim.AdamW(
            self._trained, lr=settings.lr, weight_decay=settings.weight_decay
        )
        self._settings = settings
        net.train()
        self._net = net

    def update(self, loss: Tensor, step: int) -> None:
        """One step down the gradient; `step` counts from 0."""
        fall = 0.5 * (1 + np.cos(np.pi * step / self._settings.steps))
        rate = self._settings.lr * (0.02 + 0.98 * fall) * min(1.0, (step + 1) / WARM_STEPS)
        for group in self._optimizer.param_groups:
            group["lr"] = rate
        self._net.zero_grad()
        self._optimizer.zero_grad()
        loss.backward()  # type: ignore[no-untyped-call]
        torch.nn.utils.clip_grad_norm_(self._trained, 1.0)
        self._optimizer.step()
        keep = min(AVERAGE, (step + 1) / (step + 10))
        with torch.no_grad():
            torch._foreach_lerp_(self._average, list[Tensor](self._own), 1 - keep)

    def finish(self) -> None:
        """Put the averaged weights into the network."""
        with torch.no_grad():
            torch._foreach_copy_(list[Tensor](self._own), self._average)
        self._net.eval()
