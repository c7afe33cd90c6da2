"""Made-up cells, observations and examples for the tests of policies."""

from dataclasses import replace

import numpy as np
import torch

from shared.messages.observation import Observation
from shared.policies.examples import Examples
from shared.policies.geometry import Geometry
from shared.policies.low_net import LowNet

COMMANDS = ("pick up the cheese", "put it on the plate", "wait")


def low_net(seed: int = 0) -> LowNet:
    """A small low level, untrained."""
    torch.manual_seed(seed)
    left = torch.tensor([[0.0, -0.07, 0.008], [0.0, 0.16, 0.008], [-0.33, 0.2, 0.22]])
    mirror = torch.tensor([-1.0, -1.0, 1.0])
    measures = {
        "places": torch.stack([left, left * mirror]),
        "half_heights": torch.full((7,), 0.008),
        "round": torch.tensor([0.0, 0, 0, 0, 1, 1, 1]),
        "base_x": torch.tensor(0.42),
    }
    return LowNet(Geometry(measures), width=32)


def senses(seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Proprioception [22] and objects [9, 9] of a plausible moment."""
    rng = np.random.default_rng(seed)
    joints = rng.normal(0.0, 0.3, 14)
    joints[[6, 13]] = 0.08
    tools = [[-0.2, 0.05, 0.15, 0.3], [0.2, -0.05, 0.15, -0.2]]
    objects = np.zeros((9, 9))
    objects[:, :3] = rng.uniform(-0.2, 0.2, (9, 3)) * [1, 1, 0] + [0, 0, 0.008]
    angle = rng.uniform(-0.7, 0.7, 9)
    objects[:, 3:5] = np.stack([np.cos(angle), np.sin(angle)], -1)
    objects[:, 6:8] = np.stack([-np.sin(angle), np.cos(angle)], -1)
    proprioception = np.concatenate([joints, np.ravel(tools)])
    return proprioception.astype(np.float32), objects.astype(np.float32)


def coloured(count: int, seed: int = 0) -> Examples:
    """Pictures whose colour tells the right command; the prompt and the history say nothing."""
    rng = np.random.default_rng(seed)
    kinds = rng.integers(0, len(COMMANDS), count)
    images = rng.integers(0, 60, (count, 2, 64, 64, 3)).astype(np.uint8)
    for row, kind in enumerate(kinds):
        images[row, :, 16:48, 16:48, kind] = 220
    return Examples(
        images,
        ["make a sandwich"] * count,
        [("wait",) * int(length) for length in rng.integers(0, 5, count)],
        [COMMANDS[kind] for kind in kinds],
        np.ones(count, np.float32),
        np.zeros((count, 22), np.float32),
        np.arange(count)[:, None],
    )


def moving(count: int, seed: int = 0) -> Examples:
    """Pictures that tell the right command only beside the one before: brighter, darker, alike."""
    rng = np.random.default_rng(seed)
    kinds, now = rng.integers(0, len(COMMANDS), count), rng.integers(80, 160, count)
    shades = np.stack([now - np.array([60, -60, 0])[kinds], now], 1).astype(np.uint8)
    images = np.broadcast_to(shades.reshape(-1, 1, 1, 1, 1), (2 * count, 2, 64, 64, 3)).copy()
    pairs = np.arange(2 * count).reshape(count, 2)
    return replace(
        coloured(count), images=images, labels=[COMMANDS[kind] for kind in kinds], looks=pairs
    )


def observation(
    images: np.ndarray,
    previous: tuple[str, ...] = (),
    prompt: str = "make a sandwich",
    feels: np.ndarray | None = None,
) -> Observation:
    """What the high level is asked about."""
    proprioception, objects = senses()
    proprioception = proprioception if feels is None else feels
    arrays = {"images": images, "proprioception": proprioception, "objects": objects}
    return Observation(step=0, prompt=prompt, previous=previous, arrays=arrays)
