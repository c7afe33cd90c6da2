"""Small checkpoints, quickly made: they can be hashed, loaded and trained, but do no good."""

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import torch
from safetensors.numpy import load_file, save_file

from shared.goals.language.bank import PhraseBank
from shared.goals.language.encoder import shared_encoder
from shared.messages.policy import Version
from shared.policies import checkpoint, examples
from shared.policies.checkpoint import TENSORS_FILE, Card, save
from shared.policies.examples import Examples
from shared.policies.high_level import HighLevel
from shared.policies.high_net import HighLevelNet
from tests.unit.learner.records import CHEESE, HAM, TOAST

BANK = (CHEESE, HAM, TOAST, "wait")


class Checkpoints(NamedTuple):
    """Folders that a learner starts from."""

    low_level: Path
    high_level: Path
    demonstrations: Path


def small_checkpoints(folder: Path) -> Checkpoints:
    """A high level that knows nothing yet, and demonstrations of grey pictures."""
    torch.manual_seed(0)
    net, bank = HighLevelNet(), PhraseBank.of(BANK)
    net.text.learn(BANK, shared_encoder())
    policy = HighLevel(net, bank, Version(1, 0))
    card = _card("high_level", {**policy.settings(), "bank": "\n".join(BANK)})
    checkpoint.save(folder / "high_level", policy.tensors(), card)
    shades = np.arange(24, dtype=np.uint8)[:, None, None, None, None] * np.uint8(10)
    shown = Examples(
        images=np.broadcast_to(shades, (24, 2, 64, 64, 3)).copy(),
        prompts=["make a sandwich with cheese"] * 24,
        previous=[()] * 24,
        labels=[BANK[row % 3] for row in range(24)],
        weights=np.ones(24, np.float32),
        senses=np.zeros((24, 22), np.float32),
        looks=np.arange(24)[:, None],
    )
    examples.save(folder / "demonstrations", shown, _card("demonstrations", {}))
    return Checkpoints(small_low_level(folder), folder / "high_level", folder / "demonstrations")


def _card(name: str, settings: dict[str, Any]) -> Card:
    return Card(
        name=name,
        title=name,
        version="1.0",
        date="2026-11-23",
        recipe=("by hand",),
        command="none",
        seed=0,
        data_sha256="0" * 64,
        tensors_sha256="",
        settings=settings,
    )


def small_low_level(folder: Path) -> Path:
    """A checkpoint that nobody can act with, but everybody can hash."""
    card = _card("low_level", {})
    tensors = {"enter": np.ones(4, np.float32), "exit": np.zeros((2, 3), np.float32)}
    save(folder / "low_level", tensors, card)
    return folder / "low_level"


def tamper(folder: Path) -> None:
    """Change one number."""
    tensors = load_file(folder / TENSORS_FILE)
    tensors["exit"][1, 2] = 1e-3
    save_file(tensors, folder / TENSORS_FILE)
