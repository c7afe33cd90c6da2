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
SENSES = 22


@dataclass(frozen=True, eq=False)
class Examples:
    """M decisions in order, and the P moments that they and earlier decisions looked at.

    images: [P, V, 64, 64, 3] uint8, as in `Observation`; each is kept once, however often it is
        referred to.
    prompts, previous: as in `Observation`. labels: the right command of each.
    weights: [M] float32, how often each is drawn.
    senses: [M, 22] float32, proprioception as in `Observation`.
    looks: [M, L] int64, rows of `images`: the last is the present one, before it are the earlier
        ones, oldest first, -1 where there was none.
    """

    images: NDArray[np.uint8]
    prompts: list[str]
    previous: list[tuple[str, ...]]
    labels: list[str]
    weights: NDArray[np.float32]
    senses: NDArray[np.float32]
    looks: NDArray[np.int64]

    def __post_init__(self) -> None:
        parts = (
            self.prompts,
            self.previous,
            self.labels,
            self.weights,
            self.senses,
            self.looks,
        )
        lengths = {len(part) for part in parts}
        if len(lengths) != 1:
            raise PolicyError(f"examples have parts of different lengths: {sorted(lengths)}")
        if self.looks.size and not self._looks_fit():
            raise PolicyError(
                f"examples look at moments that are not among their {len(self.images)}"
            )

    def _looks_fit(self) -> bool:
        inside = self.looks.min() >= -1 and self.looks.max() < len(self.images)
        return bool(inside and self.looks[:, -1].min() >= 0)

    def __len__(self) -> int:
        return len(self.labels)

    @property
    def present(self) -> NDArray[np.uint8]:
        """The present look of each decision, [M, V, 64, 64, 3] uint8."""
        return self.images[self.looks[:, -1]]

    def take(self, rows: Sequence[int] | NDArray[np.int64]) -> "Examples":
        """Some of them, in the order of `rows`, with the moments that they looked at."""
        rows = np.asarray(rows, np.int64)
        looks = self.looks[rows]
        used = np.unique(looks[looks >= 0])
        fresh = np.where(looks >= 0, np.searchsorted(used, looks), -1)
        return Examples(
            self.images[used],
            [self.prompts[row] for row in rows],
            [self.previous[row] for row in rows],
            [self.labels[row] for row in rows],
            self.weights[rows],
            self.senses[rows],
            fresh,
        )


def join(parts: Sequence[Examples]) -> Examples:
    """All parts one after another."""
    first = np.cumsum([0, *(len(part.images) for part in parts)])
    width = max(part.looks.shape[1] for part in parts)
    looks = [
        _widened(np.where(part.looks >= 0, part.looks + begin, -1), width)
        for part, begin in zip(parts, first[:-1], strict=True)
    ]
    return Examples(
        np.concatenate([part.images for part in parts]),
        [text for part in parts for text in part.prompts],
        [texts for part in parts for texts in part.previous],
        [text for part in parts for text in part.labels],
        np.concatenate([part.weights for part in parts]),
        np.concatenate([part.senses for part in parts]),
        np.concatenate(looks),
    )


def _widened(looks: NDArray[np.int64], width: int) -> NDArray[np.int64]:
    """The same looks, with so many columns: what was not there comes first."""
    return np.pad(looks, ((0, 0), (width - looks.shape[1], 0)), constant_values=-1)


def save(folder: Path, examples: Examples, card: Card, quality: int = 85) -> None:
    """Write as a checkpoint: pictures as sheets of JPEG, texts as UTF-8 lines."""
    tensors: Tensors = as_tensors(examples)
    flat = tensors.pop("images").reshape(-1, PIXELS, PIXELS, 3)
    for number, first in enumerate(range(0, len(flat), SHEET * SHEET)):
        sheet = _sheet(flat[first : first + SHEET * SHEET])
        packed = simplejpeg.encode_jpeg(sheet, quality, colorsubsampling="444")
        tensors[f"sheet-{number:04d}"] = np.frombuffer(packed, np.uint8)
    views, moments = int(examples.images.shape[1]), len(examples.images)
    settings = {**card.settings, "views": views, "moments": moments, "examples": len(examples)}
    checkpoint.save(folder, tensors, card.model_copy(update={"settings": settings}))


def load(folder: Path) -> Examples:
    """Read back what `save` wrote.

    Raises:
        PolicyError: the folder holds no examples.
    """
    tensors, card = checkpoint.load(folder)
    try:
        moments, views = int(card.settings["moments"]), int(card.settings["views"])
        sheets = [tensors[name] for name in sorted(tensors) if name.startswith("sheet-")]
        pictures = np.concatenate([_pictures(sheet) for sheet in sheets])[: moments * views]
        images = pictures.reshape(moments, views, PIXELS, PIXELS, 3)
        return from_tensors({**tensors, "images": images})
    except (KeyError, ValueError) as error:
        raise PolicyError(f"{folder} holds no examples: {error}") from None


def as_tensors(examples: Examples) -> Tensors:
    """All parts by name, pictures as they are."""
    return {
        "images": examples.images,
        "prompts": as_bytes(examples.prompts),
        "previous": as_bytes(["\t".join(texts) for texts in examples.previous]),
        "labels": as_bytes(examples.labels),
        "weights": examples.weights,
        "senses": examples.senses,
        "looks": examples.looks,
    }


def from_tensors(tensors: Tensors) -> Examples:
    """What `as_tensors` took apart.

    Raises:
        KeyError: a part is missing.
    """
    past = as_texts(tensors["previous"])
    return Examples(
        tensors["images"],
        as_texts(tensors["prompts"]),
        [tuple(texts.split("\t")) if texts else () for texts in past],
        as_texts(tensors["labels"]),
        tensors["weights"],
        tensors["senses"],
        tensors["looks"],
    )


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
