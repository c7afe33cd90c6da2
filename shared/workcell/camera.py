"""Pictures of the cell: small ones for policies, good-looking ones for people.

Each kind owns one GL context, made at the first picture, freed by `close`. All pictures of one
cell must come from one thread.
"""

import os
from dataclasses import dataclass

os.environ.setdefault("MUJOCO_GL", "egl")  # read once, while mujoco is imported

import mujoco
import numpy as np

CAMERA_NAMES = ("top", "angle")
DETAIL_GROUP = 1
"""Geoms that only people see: round corners, holes, ribs."""


@dataclass(frozen=True)
class Style:
    """How much work goes into a picture; drawing in software is bound by vertices and samples.

    oversample: drawn so many times larger and averaged. samples: per pixel, by OpenGL.
    shadow_pixels: side of the shadow map, 0 for none. slices: around a cylinder.
    """

    oversample: int
    samples: int
    shadow_pixels: int
    slices: int
    detail: bool


STYLES = {
    "policy": Style(oversample=2, samples=0, shadow_pixels=0, slices=12, detail=False),
    "live": Style(oversample=1, samples=0, shadow_pixels=0, slices=20, detail=True),
    "portrait": Style(oversample=1, samples=4, shadow_pixels=2048, slices=28, detail=True),
}


class Eye:
    """Draws pictures of one size in one style, with a GL context of its own."""

    def __init__(self, model: mujoco.MjModel, width: int, height: int, style: Style) -> None:
        self._style = style
        factor, visual = style.oversample, model.vis
        visual.global_.offwidth, visual.global_.offheight = width * factor, height * factor
        visual.quality.offsamples = style.samples
        visual.quality.shadowsize = style.shadow_pixels
        visual.quality.numslices = style.slices
        visual.quality.numstacks = style.slices // 2
        self._option = mujoco.MjvOption()
        self._option.geomgroup[DETAIL_GROUP] = style.detail
        self._renderer = mujoco.Renderer(model, height * factor, width * factor)

    def look(self, data: mujoco.MjData, camera: str) -> np.ndarray:
        """One picture, [height, width, 3] uint8."""
        self._renderer.update_scene(data, camera, self._option)
        flags = self._renderer.scene.flags
        flags[mujoco.mjtRndFlag.mjRND_SHADOW] = self._style.shadow_pixels > 0
        flags[mujoco.mjtRndFlag.mjRND_SKYBOX] = self._style.detail
        flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = False
        flags[mujoco.mjtRndFlag.mjRND_HAZE] = False
        pixels: np.ndarray = self._renderer.render()
        return _shrink(pixels, self._style.oversample)

    def close(self) -> None:
        """Free the GL context."""
        self._renderer.close()


def _shrink(pixels: np.ndarray, factor: int) -> np.ndarray:
    """Mean over squares of `factor` pixels, rounded."""
    if factor == 1:
        return pixels
    total = np.zeros((pixels.shape[0] // factor, pixels.shape[1] // factor, 3), np.uint16)
    for row in range(factor):
        for column in range(factor):
            total += pixels[row::factor, column::factor]
    mean: np.ndarray = (total + factor * factor // 2) // (factor * factor)
    return mean.astype(np.uint8)
