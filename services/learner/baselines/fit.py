"""Trains one arm: the same optimizer, updates, batches and witnesses for each."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn import functional as F

from services.learner.baselines.data import Looks, Teaching, lessons_of
from services.learner.baselines.net import Advice, Pair
from services.learner.pretrain.high_fit import (
    MEANING_WEIGHT,
    PROMPTS,
    SIGHT_WEIGHT,
    Lessons,
    Witness,
)
from services.learner.pretrain.low_fit import (
    DONE_WEIGHT,
    Lot,
    answers_of,
    chunk_loss,
    lot_at,
    orders,
    worth_learning,
)
from services.learner.pretrain.meanings import Meanings, Prompts, Reader
from services.learner.pretrain.practice import Steps
from shared.goals.language.bank import PhraseBank
from shared.policies.fitter import FitSettings, Fitter, Mean, keep, resumed
from shared.policies.geometry import Geometry
from shared.policies.precision import autocast, pixel_type
from shared.policies.sources import joined
from shared.policies.tokens import OBJECTS
from shared.workcell.skills import COMMANDS

KEPT_UPDATES = 200
SAMPLING_SEED = 7
"""Which of the moments in which an arm rests are left out: the same ones for every arm."""


class Fitted(NamedTuple):
    """Means over the last updates. moved: loss of the actions. goal: cross entropy of the commands,
    0 for an arm that has none. agreement: share of looks whose label came first."""

    moved: float
    goal: float
    agreement: float


class LookRows:
    """Rows of the low level, to be drawn for looks."""

    def __init__(self, looks: Looks, steps: Steps, geometry: Geometry, each: int) -> None:
        self._steps, self._geometry, self._each = steps, geometry, each
        self._moments, self._arms = worth_learning(steps, np.random.default_rng(SAMPLING_SEED))
        self._windows = np.searchsorted(self._moments, looks.windows)
        self._orders = orders()

    def draw(self, looks: NDArray[np.int64], rng: np.random.Generator) -> Lot:
        """`each` rows for each of B looks, one look after another; without weight where it has
        none."""
        first, end = np.repeat(self._windows[looks], self._each, 0).T
        rows = first + (rng.random(len(first)) * (end - first)).astype(np.int64)
        rows = np.minimum(rows, len(self._moments) - 1)
        moments, arms = self._moments[rows], self._arms[rows]
        _, answers, weights = answers_of(self._steps, moments, arms)
        weights *= (end > first)[:, None]
        felt, things = self._steps.proprioception[moments], self._steps.objects[moments]
        view = self._geometry(*map(torch.from_numpy, (felt, things, arms)))
        return lot_at(self._steps, moments, view, self._orders, (answers, weights))


class ArmFit:
    """An arm on its way.

    pair: trained in place. prompts: without pictures, in each update. kept: as for `fit_high`.
    """

    def __init__(
        self,
        pair: Pair,
        bank: PhraseBank,
        teaching: Teaching,
        settings: FitSettings,
        rows: int,
        prompts: Prompts,
        kept: Path | None = None,
    ) -> None:
        looks, steps = lessons_of(teaching, pair.arm)
        self.pair, self._settings, self._kept, self._more = pair, settings, kept, prompts
        self._ready = Lessons(looks.seen, settings.batch, bank, pair.trunk)
        self._rows = LookRows(looks, steps, pair.mover.geometry, rows)
        self._owner = torch.arange(settings.batch).repeat_interleave(rows)
        self._phrases, self._objects = torch.tensor(bank.vectors), objects_of(bank)
        torch.manual_seed(settings.seed)
        self._sight, self._reader = Witness(), Reader()
        unused = [part for part in pair.parameters() if not part.requires_grad]
        witnesses = [*self._sight.parameters(), *self._reader.parameters()]
        self._fitter = Fitter(pair, settings, witnesses, frozen=unused)
        self.done = resumed(self._fitter, kept)
        self._moved, self._goal, self._right = Mean(), Mean(), Mean()

    def run(self, until: int, progress: Callable[[int], None] | None = None) -> Fitted:
        """Train on up to `until` updates. progress: told how many there are after each."""
        for step in range(self.done, until):
            self._update(step)
            self.done = step + 1
            if self._kept and (self.done % KEPT_UPDATES == 0 or self.done == until):
                keep(self._fitter, self.done, self._kept)
            if progress:
                progress(self.done)
        return Fitted(self._moved.value, self._goal.value, self._right.value)

    def finish(self) -> None:
        """Put the averaged weights into the network."""
        self._fitter.finish()

    def _update(self, step: int) -> None:
        settings, pair = self._settings, self.pair
        rng = np.random.default_rng([settings.seed, step + 1])
        drawn = self._ready.source.choose(rng)
        batch, status, positions, meanings = self._ready.at(drawn)
        rows = self._rows.draw(drawn, rng)
        extra, extra_meanings = self._more.draw(PROMPTS, rng)
        question = batch.varied(settings, rng, pixel_type(settings.half))
        with autocast(settings.half):
            slots = pair.trunk.see(question.images)
            wishes = pair.trunk.wish(joined((question.words, extra)))
            minds, thought = pair.trunk.ponder(slots, wishes[: len(slots)], question)
            answer = pair.trunk.answer(thought)
            passed = pair.passed(answer.meaning, self._phrases, batch.labels)
            advice = pair.advise(minds, thought, passed)
            motion = pair.move(rows.view, rows.orders, advice and advice.at(self._owner))
        moved = chunk_loss(motion.changes.float(), rows.view.now, rows.answers, rows.weights)
        loss = moved + self._told(answer.meaning, batch.labels) + self._finished(motion.done, rows)
        loss = loss + self._pointed(advice, batch.labels)
        loss = loss + SIGHT_WEIGHT * self._sight.loss(slots.float(), status, positions)[0]
        both = Meanings(*map(torch.cat, zip(meanings, extra_meanings, strict=True)))
        loss = loss + MEANING_WEIGHT * self._reader.loss(wishes, both)[0]
        self._fitter.update(loss, step)
        self._moved.add(moved.item())

    def _told(self, meaning: Tensor, labels: Tensor) -> Tensor:
        """Which command was right; 0 for an arm that learns from actions alone."""
        if not self.pair.labelled:
            return torch.zeros(())
        logits = self.pair.trunk.scores(meaning, self._phrases)
        goal = F.cross_entropy(logits, labels)
        self._goal.add(goal.item())
        self._right.add((logits.argmax(-1) == labels).float().mean().item())
        return goal

    def _pointed(self, advice: Advice | None, labels: Tensor) -> Tensor:
        """Whether it points at what the right command is about; 0 where words point, or no label
        is told."""
        if advice is None or advice.pointing is None or not self.pair.labelled:
            return torch.zeros(())
        return F.cross_entropy(advice.pointing, self._objects[labels])

    def _finished(self, done: Tensor, rows: Lot) -> Tensor:
        """When a command is achieved; 0 for an arm whose goals are no commands."""
        if not self.pair.worded:
            return torch.zeros(())
        told = F.binary_cross_entropy_with_logits(done.float(), rows.done, reduction="none")
        known = rows.weights[:, 0]
        return DONE_WEIGHT * (told * known).sum() / known.sum().clamp(min=1)


def objects_of(bank: PhraseBank) -> Tensor:
    """Where each command of a bank points, [C] int64: at an object, or at none, the last row."""
    things = orders().things[[COMMANDS.index(phrase) for phrase in bank.phrases]]
    return torch.where(things < 0, OBJECTS, things)
