"""Policies on disk: safetensors beside a model card, for machines (JSON) and for people.

A checkpoint is a folder with `model.safetensors`, `card.json` and `README.md`.
"""

import hashlib
import json
from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, ValidationError
from safetensors import SafetensorError
from safetensors.numpy import load_file, save_file

from shared.errors import PolicyError

Tensors = dict[str, NDArray[Any]]
Setting = int | float | str | bool

TENSORS_FILE = "model.safetensors"
CARD_FILE = "card.json"
README_FILE = "README.md"


class Figure(BaseModel):
    """A measured rate: k of n, with its 95 % Wilson interval.

    name: what was measured, as a phrase. value: k / n.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str
    value: float
    n: int
    interval: tuple[float, float]


class Card(BaseModel):
    """What a checkpoint is, how it was made and what it can do.

    recipe: sentences, in the order of the work. command: what makes it again, with `seed`.
    data_sha256: of the data it was trained on. tensors_sha256: of all tensors, see
    `sha256_tensors`. settings: what is needed to build the network around the tensors.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str
    title: str
    version: str
    date: str
    licence: str = "Apache-2.0"
    recipe: tuple[str, ...]
    command: str
    seed: int
    data_sha256: str
    tensors_sha256: str
    figures: tuple[Figure, ...] = ()
    limits: tuple[str, ...] = ()
    settings: dict[str, Setting] = {}


def bundled(name: str) -> Path:
    """The folder of a checkpoint that comes with the project.

    Raises:
        PolicyError: there is none of this name; the message says which there are.
    """
    root = Path(str(resources.files("shared.checkpoints")))
    folder = root / name
    if not (folder / CARD_FILE).is_file():
        known = ", ".join(sorted(card.parent.name for card in root.glob(f"*/{CARD_FILE}")))
        raise PolicyError(f"no checkpoint {name!r} comes with the project; there are: {known}")
    return folder


def save(folder: Path, tensors: Mapping[str, NDArray[Any]], card: Card) -> None:
    """Write a checkpoint; `card.tensors_sha256` is filled in."""
    folder.mkdir(parents=True, exist_ok=True)
    kept = {name: np.ascontiguousarray(tensors[name]) for name in sorted(tensors)}
    card = card.model_copy(update={"tensors_sha256": sha256_tensors(kept)})
    save_file(kept, folder / TENSORS_FILE)
    (folder / TENSORS_FILE).chmod(0o644)  # safetensors writes it for its owner alone.
    (folder / CARD_FILE).write_text(card.model_dump_json(indent=2) + "\n")
    (folder / README_FILE).write_text(describe(card, kept))


def load(folder: Path) -> tuple[Tensors, Card]:
    """The tensors and the card of a checkpoint, held against one another.

    Raises:
        PolicyError: a file is missing, unreadable, or the tensors are not the card's.
    """
    card = load_card(folder)
    try:
        tensors = load_file(folder / TENSORS_FILE)
    except (OSError, SafetensorError) as error:
        raise PolicyError(f"cannot read {folder / TENSORS_FILE}: {error}") from None
    found = sha256_tensors(tensors)
    if found != card.tensors_sha256:
        raise PolicyError(
            f"the tensors in {folder} have sha256 {found}, its card says {card.tensors_sha256}"
        )
    return tensors, card


def load_card(folder: Path) -> Card:
    """The card alone.

    Raises:
        PolicyError: there is none, or it is no card.
    """
    try:
        return Card.model_validate_json((folder / CARD_FILE).read_text())
    except OSError as error:
        raise PolicyError(f"cannot read {folder / CARD_FILE}: {error.strerror}") from None
    except ValidationError as error:
        raise PolicyError(f"{folder / CARD_FILE} is no model card: {error}") from None


def sha256_tensors(tensors: Mapping[str, NDArray[Any]]) -> str:
    """One hash over names, types, shapes and bytes of all tensors, whatever their order."""
    digest = hashlib.sha256()
    for name in sorted(tensors):
        array = np.ascontiguousarray(tensors[name])
        head = json.dumps([name, str(array.dtype), list(array.shape)])
        digest.update(head.encode() + b"\n")
        digest.update(array.data.cast("B") if array.size else b"")
    return digest.hexdigest()


def describe(card: Card, tensors: Mapping[str, NDArray[Any]]) -> str:
    """The card as a page for people."""
    count = sum(array.size for array in tensors.values())
    rows = [
        f"| {figure.name} | {figure.value:.3f} | {figure.n} | "
        f"{figure.interval[0]:.3f} to {figure.interval[1]:.3f} |"
        for figure in card.figures
    ]
    table = ["", "| measured | rate | n | 95 % interval |", "|---|---|---|---|", *rows]
    return "\n".join(
        [
            f"# {card.title}",
            "",
            f"Version {card.version}, {card.date}. Licence {card.licence}. "
            f"{len(tensors)} tensors, {count:,} numbers. Read by `shared/policies`.",
            *(table if rows else []),
            "",
            "## How it was made",
            *(f"{row}. {sentence}" for row, sentence in enumerate(card.recipe, 1)),
            "",
            f"The recipe is followed by `{card.command}` (seed {card.seed}); floats differ between "
            "processors, so another machine makes its like and not the same bytes.",
            f"Data sha256 `{card.data_sha256}`, tensors sha256 `{card.tensors_sha256}`.",
            *(
                ["", "## What it can't do", *(f"- {limit}" for limit in card.limits)]
                if card.limits
                else []
            ),
            "",
        ]
    )
