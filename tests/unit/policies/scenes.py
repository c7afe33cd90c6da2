"""Made-up cells, observations and examples for the tests of policies."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import torch

from shared.messages.observation import Observation
from shared.policies.examples import Examples
from shared.policies.geometry import Geometry
from shared.policies.low_net import LowNet
from shared.policies.reader.likeness import FEATURES, Likeness
from shared.policies.reader.phrase import words_of
from shared.policies.reader.reader import Reader
from shared.policies.reader.tagger import Tagger
from shared.policies.reader.teller import SMALL_WORDS, Linear, Teller
from shared.workcell import skills

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
    """Sentences whose vectors count letters: near where texts are spelled alike."""

    def embed(self, sentences: Iterable[str]) -> np.ndarray:
        counts = [[text.count(chr(97 + row)) for row in range(26)] for text in sentences]
        vectors = np.array(counts, np.float32).reshape(-1, 26)
        vectors /= np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-6)
        return vectors

    def states(self, sentence: str) -> np.ndarray:
        return np.zeros((len(words_of(sentence)), 4), np.float32)

    def is_word(self, text: str) -> bool:
        return len(text) == 3


def words() -> Reader:
    """A reader that knows the canonical commands and takes all else for courtesy."""
    tagger = Tagger(torch.zeros(4), torch.ones(4), 2, 2)
    for weight in tagger.parameters():
        torch.nn.init.zeros_(weight)  # No part stands out, so the first, courtesy, is told.
    verbs = np.array([0] * 15 + [1, 2, 3, 4, 5])
    things = np.array([*range(15), 15, 16, 17, -1, -1])
    acts, names, places = (teller(count) for count in (7, 15, 4))
    return Reader(skills.COMMANDS, verbs, things, tagger.eval(), acts, names, places, Letters())


def teller(classes: int) -> Teller:
    """One known text for each class and one for none of them, which it always leans to."""
    texts = [COMMANDS[row % 3] for row in range(classes + 1)]
    linear = np.zeros((classes + 1, 26 + len(SMALL_WORDS)), np.float32)
    bias = np.eye(classes + 1, dtype=np.float32)[-1] * 9
    weights = np.zeros((2, FEATURES + 1), np.float32)
    weights[1, -1] = 9.0
    known = Likeness(texts, np.arange(classes + 1), Letters().embed(texts), weights)
    return Teller(Linear(linear, bias), known)


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


def gripping(thing: int) -> tuple[np.ndarray, np.ndarray]:
    """The same with the left hand closed around a thing."""
    body, objects = senses()
    body[6] = 0.03
    objects[thing, :3] = body[14:17]
    return body, objects


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
