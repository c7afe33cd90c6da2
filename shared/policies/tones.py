"""Shows pictures in the tones of others, so that a demonstration looks as if made elsewhere.

Light and shades differ from site to site, what is to be done doesn't: a demonstration in the tones
of the pictures that were corrected tells eyes at that site what they have to see.

Source: Reinhard et al. 2001 (Color Transfer between Images, IEEE CG&A 21:5): mean and spread of
each channel; ours of red, green and blue as they are, of each view.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shared.policies.reading import Pictures

LEAST_SPREAD = 1.0
"""In levels of 0..255: a view that is all one colour has no spread to be changed."""


class Tones(NamedTuple):
    """Of pictures, by view: mean and spread of each channel, both [V, 3] in levels of 0..255."""

    mean: NDArray[np.float32]
    spread: NDArray[np.float32]


def tones_of(images: Pictures) -> Tones:
    """Those of pictures [P, V, H, W, 3], P > 0, all taken together."""
    means = np.stack([image.mean((1, 2), np.float64) for image in images])
    squares = np.stack([np.square(image, dtype=np.float64).mean((1, 2)) for image in images])
    mean = means.mean(0)
    spread = np.sqrt(np.maximum(squares.mean(0) - np.square(mean), LEAST_SPREAD**2))
    return Tones(mean.astype(np.float32), spread.astype(np.float32))


def retoned(images: Pictures, old: Tones, new: Tones) -> Pictures:
    """Pictures [..., V, H, W, 3] of some tones, in others."""
    factor = new.spread / old.spread
    moved = images * factor[:, None, None] + (new.mean - old.mean * factor)[:, None, None]
    clear: Pictures = np.clip(np.rint(moved), 0, 255).astype(np.uint8)
    return clear
