"""Where the batches of a fit come from: examples made ready once, then drawn by their weights."""

from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn import functional as F

from shared.errors import PolicyError
from shared.goals.language.bank import PhraseBank
from shared.goals.language.encoder import Encoder
from shared.policies.examples import Examples
from shared.policies.high_net import HighLevelNet, Question, Sights
from shared.policies.reading import (
    Pictures,
    blinking,
    forgetful,
    gains,
    halved,
    past_rows,
    read_words,
    relit,
    shifted,
)
from shared.policies.tones import Tones, retoned, tones_of
from shared.policies.variation import Variation
from shared.policies.wishes import Words

CHUNK = 4096
PICTURE = (2, 64, 64, 3)
EACH = 128
"""Moments that are looked at at once."""
VARIATIONS = 3
"""How often frozen eyes look at each picture, each time in another light, a little moved."""


class Batch(NamedTuple):
    """B decisions as they were seen, and the rows of the bank that answer them.

    images: [B, V, 64, 64, 3] uint8. glimpses: [B, K + 1, V, 32, 32, 3] uint8. seen, senses, words,
    previous, sights: as in `Question`. labels: [B] int64.
    """

    images: Pictures
    glimpses: Pictures
    seen: NDArray[np.bool_]
    senses: Tensor
    words: Words
    previous: Tensor
    labels: Tensor
    sights: Sights | None = None

    def question(self) -> Question:
        """As they were seen."""
        images, glimpses = torch.from_numpy(self.images), torch.from_numpy(self.glimpses)
        return Question(
            images, glimpses, torch.from_numpy(self.seen), self.senses, self.words, self.previous
        )

    def varied(
        self, by: Variation, rng: np.random.Generator, dtype: torch.dtype = torch.float32
    ) -> Question:
        """Seen a little differently: moved, in another light, with noise and gaps."""
        images, glimpses = (
            _untouched(self)
            if self.sights
            else varied_pictures(self.images, self.glimpses, by, rng, dtype)
        )
        seen = blinking(self.seen, by.look_dropout, by.look_dropout / 2, rng)
        senses = self.senses + by.sense_noise * torch.from_numpy(
            rng.standard_normal(self.senses.shape, dtype=np.float32)
        )
        return Question(
            images,
            glimpses,
            torch.from_numpy(seen),
            senses,
            self.words,
            forgetful(self.previous, by.history_dropout, by.history_dropout / 2, rng),
            self.sights,
        )


def varied_pictures(
    images: Pictures,
    glimpses: Pictures,
    by: Variation,
    rng: np.random.Generator,
    dtype: torch.dtype = torch.float32,
) -> tuple[Tensor, Tensor]:
    """Pictures of B decisions moved, in another light, with noise; shapes as in `Batch`."""
    count, views = images.shape[:2]
    looks = glimpses.shape[1]
    offsets = rng.integers(-by.shift_px, by.shift_px + 1, (count, views, 2))
    moved = shifted(images.reshape(-1, *images.shape[2:]), offsets.reshape(-1, 2), by.shift_px)
    half = np.repeat(offsets[:, None] // 2, looks, 1).reshape(-1, 2)
    less = shifted(glimpses.reshape(-1, *glimpses.shape[3:]), half, (by.shift_px + 1) // 2)
    gain = gains(count, by.brightness, by.tint, rng)
    return (
        relit(moved.reshape(images.shape), gain, by.noise, rng, dtype),
        relit(less.reshape(glimpses.shape), gain, 0.0, rng, dtype),
    )


def _untouched(batch: Batch) -> tuple[Tensor, Tensor]:
    return torch.from_numpy(batch.images), torch.from_numpy(batch.glimpses)


class Source:
    """Examples that a fixed number of each batch is drawn from, by their weights."""

    def __init__(
        self,
        examples: Examples,
        count: int,
        bank: PhraseBank,
        encoder: Encoder,
        net: HighLevelNet,
    ) -> None:
        total = float(examples.weights.sum())
        if total <= 0:
            raise PolicyError("there is nothing to learn from: all examples have weight 0")
        self.count = count
        self._sums: NDArray[np.float64] = np.cumsum(examples.weights, dtype=np.float64) / total
        self._images, self._halves = examples.images, _all_halved(examples.images)
        self._looks = fitted(examples.looks, net.looks)
        self._senses = torch.from_numpy(examples.senses)
        prompts = sorted(set(examples.prompts))
        number = {prompt: row for row, prompt in enumerate(prompts)}
        self._prompt = torch.tensor([number[prompt] for prompt in examples.prompts])
        self._words = read_words(encoder, prompts)
        table, past = past_rows(encoder, examples.previous, net.history)
        self._said, self._past = torch.from_numpy(table), torch.from_numpy(past)
        rows = {phrase: row for row, phrase in enumerate(bank.phrases)}
        unknown = sorted(set(examples.labels) - set(rows))
        if unknown:
            raise PolicyError(f"labels that the bank does not hold: {', '.join(unknown)}")
        self._labels = torch.tensor([rows[label] for label in examples.labels])
        self._sights: Sights | None = None
        self._tones: tuple[Tones, Tones, float] | None = None

    def draw(self, rng: np.random.Generator) -> Batch:
        """`count` examples, with replacement."""
        rows = self.choose(rng)
        batch = self.at(rows)
        if self._sights:
            return batch._replace(sights=self._seen_before(rows, rng))
        return self._retoned(batch, rng) if self._tones else batch

    def retone(self, tones: Tones, share: float) -> None:
        """Show a share of what is drawn from now on in these tones; not to frozen eyes."""
        self._tones = tones_of(self._images), tones, share

    def _retoned(self, batch: Batch, rng: np.random.Generator) -> Batch:
        assert self._tones is not None  # The caller looked.
        old, new, share = self._tones
        rows = rng.random(len(batch.images)) < share
        # They are copies of what is kept, and of nobody else.
        batch.images[rows] = retoned(batch.images[rows], old, new)
        batch.glimpses[rows] = retoned(batch.glimpses[rows], old, new)
        return batch

    def remember(self, net: HighLevelNet, by: Variation, seed: int) -> None:
        """Let frozen eyes look at all pictures now, in `VARIATIONS`; batches carry what they saw.

        Of a picture that is only an earlier look the small eye alone sees anything.
        """
        rng = np.random.default_rng([seed, 0])
        moments = len(self._images)
        present = np.unique(self._looks[:, -1])
        with torch.no_grad():
            eyes = torch.zeros(VARIATIONS, moments, *net.look(torch.zeros(1, *PICTURE)).shape[1:])
            glances = torch.zeros(VARIATIONS, moments, net.glance_width)
            for variation in range(VARIATIONS):
                for rows in np.array_split(np.arange(moments), 1 + moments // EACH):
                    shown = varied_pictures(
                        self._images[rows], self._halves[rows][:, None], by, rng
                    )
                    glances[variation, rows] = net.glimpse(shown[1])[:, 0]
                    here = np.isin(rows, present)
                    if here.any():
                        eyes[variation, rows[here]] = net.look(shown[0][here])
        self._sights = Sights(eyes, glances)

    def _seen_before(self, rows: NDArray[np.int64], rng: np.random.Generator) -> Sights:
        assert self._sights is not None  # The caller looked.
        variation = torch.from_numpy(rng.integers(VARIATIONS, size=len(rows)))
        looks = torch.from_numpy(self._looks[rows])  # -1 is hidden by `seen`.
        return Sights(
            self._sights.eyes[variation, looks[:, -1]],
            self._sights.glances[variation[:, None], looks],
        )

    def choose(self, rng: np.random.Generator) -> NDArray[np.int64]:
        """Rows drawn by weight."""
        rows = np.searchsorted(self._sums, rng.random(self.count), side="right")
        return np.minimum(rows, len(self._sums) - 1)

    def at(self, rows: NDArray[np.int64]) -> Batch:
        """The examples of these rows."""
        looks, prompt = self._looks[rows], self._prompt[rows]
        there = self._words.there[prompt]
        longest = int(there.sum(1).max())
        return Batch(
            self._images[looks[:, -1]],
            self._halves[looks],
            looks >= 0,
            self._senses[rows],
            Words(self._words.states[prompt, :longest], there[:, :longest]),
            self._said[self._past[rows]],
            self._labels[rows],
        )


def _all_halved(images: Pictures) -> Pictures:
    """`halved`, some at a time: the sums in between take twice the room of the result."""
    height, width, channels = images.shape[2:]
    halves = np.empty((*images.shape[:2], height // 2, width // 2, channels), np.uint8)
    for first in range(0, len(images), CHUNK):
        halves[first : first + CHUNK] = halved(images[first : first + CHUNK])
    return halves


def fitted(looks: NDArray[np.int64], width: int) -> NDArray[np.int64]:
    """The last `width` looks of each decision, -1 before them where there are fewer."""
    missing = max(0, width - looks.shape[1])
    return np.pad(looks, ((0, 0), (missing, 0)), constant_values=-1)[:, -width:]


def merge(batches: list[Batch]) -> Batch:
    """Batches one after another."""
    if len(batches) == 1:
        return batches[0]
    images, glimpses, seen, senses, words, previous, labels, sights = zip(*batches, strict=True)
    return Batch(
        np.concatenate(images),
        np.concatenate(glimpses),
        np.concatenate(seen),
        torch.cat(senses),
        joined(words),
        torch.cat(previous),
        torch.cat(labels),
        Sights(*map(torch.cat, zip(*sights, strict=True))) if all(sights) else None,
    )


def joined(parts: tuple[Words, ...]) -> Words:
    """Prompts one after another, padded to the longest."""
    longest = max(part.there.shape[1] for part in parts)
    gaps = [longest - part.there.shape[1] for part in parts]
    states = [F.pad(part.states, (0, 0, 0, gap)) for part, gap in zip(parts, gaps, strict=True)]
    there = [F.pad(part.there, (0, gap)) for part, gap in zip(parts, gaps, strict=True)]
    return Words(torch.cat(states), torch.cat(there))
