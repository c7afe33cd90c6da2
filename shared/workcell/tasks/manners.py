"""The ways in which people put a wish into words; a site has one of them."""

from typing import Literal

import numpy as np

Manner = Literal["plain", "polite", "chatty"]

_FRAMES: dict[Manner, tuple[str, ...]] = {
    "plain": ("{}",),
    "polite": (
        "please {}",
        "could you please {}?",
        "would you {}, please?",
        "would you be so kind to {}?",
    ),
    "chatty": (
        "ok, next job: {}",
        "hey robot, {} if you have a moment",
        "we are busy today, so {}, will you?",
        "hello there, I need you to {} now, that would be great",
        "right, when you are ready {}",
    ),
}


def put(core: str, manner: Manner, rng: np.random.Generator) -> str:
    """An imperative clause in this manner. Plain words stay as they are and draw nothing."""
    frames = _FRAMES[manner]
    if len(frames) == 1:
        return frames[0].format(core)
    return frames[int(rng.integers(len(frames)))].format(core)
