"""Made-up cells, observations and examples for the tests of policies."""

from dataclasses import replace

import numpy as np
import torch

from shared.goals.family import Floats
from shared.messages.goal import Goal
from shared.messages.observation import Observation
from shared.policies.examples import Examples
from shared.policies.geometry import Geometry
from shared.policies.low_net import LowNet
from shared.policies.reader import Reader

COMMANDS = ("pick up the cheese", "put it on the plate", "wait")


def low_net(seed: int = 0) -> LowNet:
    """A small low level, untrained."""
    torch.manual_seed(seed)
    flat = torch.tensor([0.0] * 4 + [1.0] * 3 + [0.0] * 8)
    block = torch.tensor([0.0] * 7 + [1.0, 0, 1, 0, 1, 1, 1, 0])
    measures = {
        "sizes": torch.tensor([[0.027, 0.030, 0.009]]).repeat(15, 1),
        "round": flat,
        "block": block,
        "base_x": torch.tensor(0.42),
        "plate_top": torch.tensor(0.008),
        "floor": torch.tensor(0.006),
        "slot": torch.tensor(0.047),
        "spots": torch.tensor([[0.14, -0.1], [0.2, 0.1]]),
        "tub_spots": torch.tensor([[0.18, -0.1]]),
        "home": torch.tensor([[-0.33, 0.2, 0.22], [0.33, -0.2, 0.22]]),
    }
    return LowNet(Geometry(measures), width=32)


class Letters:
    """A family whose vectors count letters: near where texts are spelled alike."""

    name, width = "language", 26

    def embed(self, goals: tuple[Goal, ...]) -> Floats:
        counts = [[goal.text.count(chr(97 + row)) for row in range(26)] for goal in goals]
        vectors = np.array(counts, np.float32)
        vectors /= np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-6)
        return vectors

    def describe(self, goal: Goal) -> str:
        return goal.text


def words(threshold: float = 0.9) -> Reader:
    """A reader of four commands, the first about row 2, the second about the plate."""
    commands = ("pick up the cheese", "put it on the plate", "put it down", "wait")
    phrases, owners = (*commands, "grab the cheese"), np.array([0, 1, 2, 3, 0])
    vectors = Letters().embed(tuple(Goal(text=text) for text in phrases))
    verbs, things = np.array([0, 1, 4, 5]), np.array([2, 15, -1, -1])
    return Reader(commands, verbs, things, phrases, owners, vectors, threshold, Letters())


def senses(seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Proprioception [22] and objects [18, 9] of a plausible moment in the kitchen."""
    rng = np.random.default_rng(seed)
    joints = rng.normal(0.0, 0.3, 14)
    joints[[6, 13]] = 0.08
    tools = [[-0.2, 0.05, 0.15, 0.3], [0.2, -0.05, 0.15, -0.2]]
    objects = np.zeros((18, 9))
    objects[:, :3] = rng.uniform(-0.2, 0.2, (18, 3)) * [1, 1, 0] + [0, 0, 0.008]
    angle = rng.uniform(-0.7, 0.7, 18)
    objects[:, 3:5] = np.stack([np.cos(angle), np.sin(angle)], -1)
    objects[:, 6:8] = np.stack([-np.sin(angle), np.cos(angle)], -1)
    objects[[*range(7, 15), 17]] = 0.0
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
