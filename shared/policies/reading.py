"""Turns observations and examples into the arrays that the high level's network reads."""

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn import functional as F

from shared.goals.family import Floats
from shared.goals.language.encoder import TOKEN_WIDTH, WIDTH, Encoder
from shared.policies.wishes import Words

Pictures = NDArray[np.uint8]


def past_vectors(encoder: Encoder, previous: Sequence[Sequence[str]], history: int) -> Floats:
    """Vectors of the last `history` commands, [B, H, 384], oldest first, zeros where none was."""
    table, rows = past_rows(encoder, previous, history)
    vectors: Floats = table[rows]
    return vectors


def past_rows(
    encoder: Encoder, previous: Sequence[Sequence[str]], history: int
) -> tuple[Floats, NDArray[np.int64]]:
    """The same as a table [N, 384], whose first row is zero, and rows of it [B, H]."""
    known = {text: row for row, text in enumerate(sorted({t for ts in previous for t in ts}), 1)}
    table = np.concatenate([np.zeros((1, WIDTH), np.float32), encoder.embed(known)])
    rows = np.zeros((len(previous), history), np.int64)
    for row, texts in zip(rows, previous, strict=True):
        last = [known[text] for text in texts][-history:] if history else []
        row[history - len(last) :] = last
    return table, rows


def read_words(encoder: Encoder, prompts: Sequence[str]) -> Words:
    """Prompts word piece by word piece, padded."""
    pieces = encoder.tokens(prompts)
    longest = max(map(len, pieces))
    states = torch.zeros(len(pieces), longest, TOKEN_WIDTH, dtype=torch.bfloat16)
    there = torch.zeros(len(pieces), longest, dtype=torch.bool)
    for row, vectors in enumerate(pieces):
        states[row, : len(vectors)] = F.layer_norm(torch.from_numpy(vectors), (TOKEN_WIDTH,))
        there[row, : len(vectors)] = True
    return Words(states, there)


def halved(images: Pictures) -> Pictures:
    """Pictures [..., H, W, 3] at half the size, each pixel the mean of four."""
    *front, height, width, channels = images.shape
    quads = images.reshape(*front, height // 2, 2, width // 2, 2, channels)
    sums = quads[..., 0, :, 0, :].astype(np.uint16)
    for down, right in ((0, 1), (1, 0), (1, 1)):
        sums += quads[..., down, :, right, :]
    halves: Pictures = (sums // 4).astype(np.uint8)
    return halves


def shifted(images: Pictures, offsets: NDArray[np.int64], most_px: int) -> Pictures:
    """Pictures [N, H, W, 3] moved down and right by offsets [N, 2], edges repeated.

    most_px: no offset is larger.
    """
    edges = ((0, 0), (most_px, most_px), (most_px, most_px), (0, 0))
    padded, moved = np.pad(images, edges, mode="edge"), np.empty_like(images)
    height, width = images.shape[1:3]
    for row, (down, right) in enumerate((most_px - offsets).tolist()):
        moved[row] = padded[row, down : down + height, right : right + width]
    return moved


def gains(count: int, brightness: float, tint: float, rng: np.random.Generator) -> Tensor:
    """Another light for each sample: factors on its colours, [B, 3]."""
    level = rng.uniform(-brightness, brightness, (count, 1))
    light = 1.0 + level + rng.uniform(-tint, tint, (count, 3))
    return torch.from_numpy(light.astype(np.float32))


def relit(
    images: Pictures,
    gain: Tensor,
    noise: float,
    rng: np.random.Generator,
    dtype: torch.dtype = torch.float32,
) -> Tensor:
    """Pictures [B, ..., H, W, 3] in the light of their sample, with noise on each pixel."""
    shape, size = images.shape[1:], int(np.prod(images.shape[1:]))
    relit = torch.empty(images.shape, dtype=dtype)
    # Each sample gets a window of one long strip of noise: drawing it afresh costs more than a
    # third of an update. Sample by sample all stays in the processor's cache.
    strip = torch.from_numpy(rng.standard_normal(2 * size, dtype=np.float32) * np.float32(noise))
    windows = rng.integers(0, size, len(images)).tolist()
    for row, first in enumerate(windows):
        pixels = torch.from_numpy(images[row]).float().mul_(gain[row])
        if noise:
            pixels.add_(strip[first : first + size].view(shape))
        relit[row] = pixels.clamp_(0.0, 255.0)
    return relit


def forgetful(previous: Tensor, whole: float, each: float, rng: np.random.Generator) -> Tensor:
    """Histories [B, H, 384], some wiped out, and single commands of others, so that none is merely
    repeated."""
    count, history = previous.shape[:2]
    kept: NDArray[np.bool_] = rng.random((count, 1)) >= whole
    kept = kept & (rng.random((count, history)) >= each)
    return previous * torch.from_numpy(kept)[:, :, None]


def blinking(
    seen: NDArray[np.bool_], whole: float, each: float, rng: np.random.Generator
) -> NDArray[np.bool_]:
    """Which looks [B, K + 1] are shown: always the last; of some samples no earlier one, and single
    ones of others are hidden."""
    count, looks = seen.shape
    kept: NDArray[np.bool_] = seen & (rng.random((count, 1)) >= whole)
    kept &= rng.random((count, looks)) >= each
    kept[:, -1] = seen[:, -1]
    return kept
