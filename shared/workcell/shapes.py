"""What the looks of things are made of: MJCF geoms that collide with nothing."""

import colorsys
from collections.abc import Callable
from math import cos, pi, sin

from shared.workcell.objects import Object
from shared.workcell.site import Colour, Shades

Look = Callable[[Object, list[str]], str]
"""From a thing and its colours at a site to its visible geoms."""


def shaded(colour: Colour, name: str, shades: Shades) -> str:
    """A colour as the site shows it on the thing called `name`."""
    hue, saturation, value = colorsys.rgb_to_hsv(*colour)
    hue += shades.objects.get(name, shades.hue)
    now = colorsys.hsv_to_rgb(
        hue % 1.0, min(1.0, saturation * shades.saturation), min(1.0, value * shades.value)
    )
    return " ".join(f"{part:.4f}" for part in now) + " 1"


def geom(
    kind: str, size: str, rgba: str, at: str = "0 0 0", detail: bool = False, more: str = ""
) -> str:
    """One visible part of a thing. more: further attributes."""
    group = "detail" if detail else "food"
    return f'<geom class="{group}" type="{kind}" size="{size}" pos="{at}" rgba="{rgba}" {more}/>\n'


def rounded(half: float, height: float, radius: float, rgba: str) -> str:
    """A square slab with round corners: two crossed boxes and four cylinders, detail if small."""
    flat, small = half - radius, radius < 0.01
    corners = "".join(
        geom("cylinder", f"{radius} {height - 0.0004}", rgba, f"{x * flat} {y * flat} 0", small)
        for x in (-1, 1)
        for y in (-1, 1)
    )
    long = geom("box", f"{half} {flat} {height}", rgba)
    return long + geom("box", f"{flat} {half} {height - 0.0001}", rgba) + corners


def disc(radius: float, height: float, rgba: str, at: str = "0 0 0", detail: bool = False) -> str:
    """An upright cylinder; `height` is half of it."""
    return geom("cylinder", f"{radius} {height}", rgba, at, detail)


def dots(radius: float, height: float, rgba: str, places: list[str]) -> str:
    """Small discs, left out of small pictures."""
    return "".join(disc(radius, height, rgba, at, detail=True) for at in places)


def ring(count: int, radius: float, start: float = 0.0) -> list[str]:
    """Places around a circle, as positions."""
    angles = [start + 2 * pi * step / count for step in range(count)]
    return [f"{radius * cos(angle):.5f} {radius * sin(angle):.5f} 0" for angle in angles]
