"""Turns observations and examples into the arrays that the high level's network reads."""

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from shared.goals.family import Floats
from shared.goals.language.encoder import WIDTH, Encoder


def past_vectors(encoder: Encoder, previous: Sequence[Sequence[str]], history: int) -> Floats:
    """Vectors of the last `history` commands, [B, H, 384], oldest first, zeros where none was."""
    vectors = np.zeros((len(previous), history, WIDTH), np.float32)
    known = {text: encoder.embed([text])[0] for texts in previous for text in texts}
    for row, texts in enumerate(previous):
        last = list(texts)[-history:] if history else []
        for place, text in enumerate(last, history - len(last)):
            vectors[row, place] = known[text]
    return vectors


def shifted(images: Tensor, most_px: int, rng: np.random.Generator) -> Tensor:
    """Each picture of [B, V, 64, 64, 3] moved by up to `most_px`, edges repeated."""
    count, views, height, width, channels = images.shape
    down = rng.integers(-most_px, most_px + 1, (count * views, 1))
    right = rng.integers(-most_px, most_px + 1, (count * views, 1))
    rows = torch.from_numpy(np.clip(np.arange(height) + down, 0, height - 1))
    columns = torch.from_numpy(np.clip(np.arange(width) + right, 0, width - 1))
    flat = images.reshape(count * views, height, width, channels)
    index = torch.arange(count * views)[:, None, None]
    return flat[index, rows[:, :, None], columns[:, None, :]].reshape(images.shape)


def relit(
    pixels: Tensor, brightness: float, tint: float, noise: float, rng: np.random.Generator
) -> Tensor:
    """Float pictures [B, V, H, W, 3] in another light for each sample, with noise on each pixel."""
    count, size = len(pixels), pixels[0].numel()
    level = rng.uniform(-brightness, brightness, (count, 1, 1, 1, 1))
    gain = (1.0 + level + rng.uniform(-tint, tint, (count, 1, 1, 1, 3))).astype(np.float32)
    # Each sample gets a window of one long strip of noise: drawing it afresh costs more than a
    # third of a step of training.
    strip = torch.from_numpy(rng.standard_normal(2 * size, dtype=np.float32) * np.float32(noise))
    windows = strip.unfold(0, size, 1)[torch.from_numpy(rng.integers(0, size, count))]
    bright: Tensor = pixels * torch.from_numpy(gain) + windows.reshape(pixels.shape)
    return bright.clamp_(0.0, 255.0)


def forgetful(previous: Tensor, dropout: float, rng: np.random.Generator) -> Tensor:
    """Histories [B, H, 384], some of them wiped out, so that none is merely repeated."""
    kept: NDArray[np.bool_] = rng.random(len(previous)) >= dropout
    return previous * torch.from_numpy(kept)[:, None, None]
