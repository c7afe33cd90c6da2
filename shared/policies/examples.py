"""What the high level learns from: decisions with the command that would have been right."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import simplejpeg
from numpy.typing import NDArray

from shared.errors import PolicyError
from shared.policies import checkpoint
from shared.policies.checkpoint import Card, Tensors

SHEET = 8
"""Pictures a side of a sheet: small JPEGs are mostly head, so many pictures share one."""
PIXELS = 64


@dataclass(frozen=True, eq=False)
class Examples:
    """M decisions in order.

    images: [M, V, 64, 64, 3] uint8, as in `Observation`. prompts, previous: as there.
    labels: the right command of each. weights: [M] float32, how often each is drawn.
    """

    images: NDArray[np.uint8]
    prompts: list[str]
    previous: list[tuple[str, ...]]
    labels: list[str]
    weights: NDArray[np.float32]

    def __post_init__(self) -> None:
        lengths = {
            len(part)
            for part in (self.images, self.prompts, self.previous, self.labels, self.weights)
        }
        if len(lengths) != 1:
            raise PolicyError(f"examples have parts of different lengths: {sorted(lengths)}")

    def __len__(self) -> int:
        return len(self.labels)

    def take(self, rows: Sequence[int] | NDArray[np.int64]) -> "Examples":
        """Some of them, in the order of `rows`."""
        return Examples(
            self.images[rows],
            [self.prompts[row] for row in rows],
            [self.previous[row] for row in rows],
            [self.labels[row] for row in rows],
            self.weights[rows],
        )


def join(parts: Sequence[Examples]) -> Examples:
    """All parts one after another."""
    return Examples(
        np.concatenate([part.images for part in parts]),
        [text for part in parts for text in part.prompts],
        [texts for part in parts for texts in part.previous],
        [text for part in parts for text in part.labels],
        np.concatenate([part.weights for part in parts]),
    )


def save(folder: Path, examples: Examples, card: Card, quality: int = 85) -> None:
    """Write as a checkpoint: pictures as sheets of JPEG, texts as UTF-8 lines."""
    tensors: Tensors = {"weights": examples.weights}
    flat = examples.images.reshape(-1, PIXELS, PIXELS, 3)
    for number, first in enumerate(range(0, len(flat), SHEET * SHEET)):
        sheet = _sheet(flat[first : first + SHEET * SHEET])
        packed = simplejpeg.encode_jpeg(sheet, quality, colorsubsampling="444")
        tensors[f"sheet-{number:04d}"] = np.frombuffer(packed, np.uint8)
    tensors["prompts"] = as_bytes(examples.prompts)
    tensors["labels"] = as_bytes(examples.labels)
    tensors["previous"] = as_bytes(["\t".join(texts) for texts in examples.previous])
    views = int(examples.images.shape[1])
    settings = {**card.settings, "views": views, "examples": len(examples)}
    checkpoint.save(folder, tensors, card.model_copy(update={"settings": settings}))


def load(folder: Path) -> Examples:
    """Read back what `save` wrote.

    Raises:
        PolicyError: the folder holds no examples.
    """
    tensors, card = checkpoint.load(folder)
    try:
        count, views = int(card.settings["examples"]), int(card.settings["views"])
        sheets = [tensors[name] for name in sorted(tensors) if name.startswith("sheet-")]
        pictures = np.concatenate([_pictures(sheet) for sheet in sheets])[: count * views]
        past = as_texts(tensors["previous"])
        return Examples(
            pictures.reshape(count, views, PIXELS, PIXELS, 3),
            as_texts(tensors["prompts"]),
            [tuple(texts.split("\t")) if texts else () for texts in past],
            as_texts(tensors["labels"]),
            tensors["weights"],
        )
    except (KeyError, ValueError) as error:
        raise PolicyError(f"{folder} holds no examples: {error}") from None


def _sheet(pictures: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Up to 64 pictures side by side, [512, 512, 3]."""
    full = np.zeros((SHEET * SHEET, PIXELS, PIXELS, 3), np.uint8)
    full[: len(pictures)] = pictures
    grid = full.reshape(SHEET, SHEET, PIXELS, PIXELS, 3).swapaxes(1, 2)
    return np.ascontiguousarray(grid.reshape(SHEET * PIXELS, SHEET * PIXELS, 3))


def _pictures(packed: NDArray[Any]) -> NDArray[np.uint8]:
    """The 64 pictures of a sheet, [64, 64, 64, 3]."""
    sheet = simplejpeg.decode_jpeg(packed.tobytes())
    grid = sheet.reshape(SHEET, PIXELS, SHEET, PIXELS, 3).swapaxes(1, 2)
    return np.ascontiguousarray(grid.reshape(SHEET * SHEET, PIXELS, PIXELS, 3))


def as_bytes(texts: list[str]) -> NDArray[np.uint8]:
    """Texts without line breaks as UTF-8 lines, [L]."""
    return np.frombuffer("\n".join(texts).encode(), np.uint8)


def as_texts(packed: NDArray[Any]) -> list[str]:
    """The texts that `as_bytes` packed."""
    return packed.tobytes().decode().split("\n")
