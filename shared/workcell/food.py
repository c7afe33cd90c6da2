"""How the food looks, as MJCF geoms that collide with nothing. Sizes: objects.py."""

import colorsys
from math import cos, pi, sin

from shared.workcell.objects import Object
from shared.workcell.site import Colour, Shades

_COLOURS: dict[str, tuple[Colour, ...]] = {
    "bread": ((0.80, 0.56, 0.30), (0.97, 0.89, 0.72)),
    "toast": ((0.36, 0.19, 0.08), (0.62, 0.36, 0.15)),
    "cheese": ((1.00, 0.80, 0.12), (0.93, 0.66, 0.05)),
    "ham": ((0.96, 0.66, 0.68), (0.90, 0.47, 0.54), (0.97, 0.76, 0.76)),
    "lettuce": ((0.30, 0.66, 0.16), (0.46, 0.80, 0.26), (0.66, 0.88, 0.44)),
    "tomato": ((0.82, 0.10, 0.07), (0.93, 0.22, 0.14), (0.98, 0.55, 0.22)),
    "onion": ((0.50, 0.16, 0.46), (0.93, 0.88, 0.93), (0.70, 0.42, 0.68)),
}


def look_xml(item: Object, shades: Shades) -> str:
    """The visible geoms of one object at a site."""
    colours = [shaded(colour, item.name, shades) for colour in _COLOURS[item.name]]
    draw = {
        "bread": _loaf,
        "toast": _loaf,
        "cheese": _cheese,
        "ham": _ham,
        "lettuce": _lettuce,
        "tomato": _tomato,
        "onion": _onion,
    }[item.name]
    return draw(item.half_width_m, item.half_height_m, colours)


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
    return geom("cylinder", f"{radius} {height}", rgba, at, detail)


def _dots(radius: float, height: float, rgba: str, places: list[str]) -> str:
    return "".join(disc(radius, height, rgba, at, detail=True) for at in places)


def ring(count: int, radius: float, start: float = 0.0) -> list[str]:
    """Places around a circle, as positions."""
    angles = [start + 2 * pi * step / count for step in range(count)]
    return [f"{radius * cos(angle):.5f} {radius * sin(angle):.5f} 0" for angle in angles]


def _loaf(half: float, height: float, colours: list[str]) -> str:
    crust, crumb = colours
    inner = rounded(half - 0.0045, height + 0.0006, 0.007, crumb)
    return rounded(half, height, 0.009, crust) + inner


def _cheese(half: float, height: float, colours: list[str]) -> str:
    holes = ((0.010, 0.012, 0.005), (-0.012, 0.004, 0.0065), (0.006, -0.012, 0.004))
    dots = "".join(_dots(r, height + 0.0004, colours[1], [f"{x} {y} 0"]) for x, y, r in holes)
    return rounded(half, height, 0.003, colours[0]) + dots


def _ham(half: float, height: float, colours: list[str]) -> str:
    rind, meat, fat = colours
    inner = rounded(half - 0.003, height + 0.0006, 0.014, meat)
    streaks = _dots(0.0028, height + 0.0010, fat, ring(5, 0.013, 0.4))
    return rounded(half, height, 0.016, rind) + inner + streaks


def _lettuce(radius: float, height: float, colours: list[str]) -> str:
    dark, leaf, vein = colours
    frill = "".join(
        geom("ellipsoid", f"0.009 0.009 {height}", dark, at, detail=True)
        for at in ring(9, radius - 0.006)
    )
    edge = disc(radius - 0.001, height - 0.002, dark)
    ribs = _dots(0.0026, height + 0.0012, vein, [*ring(6, 0.012, 0.3), "0 0 0"])
    return edge + frill + disc(radius - 0.005, height, leaf) + ribs


def _tomato(radius: float, height: float, colours: list[str]) -> str:
    skin, flesh, seeds = colours
    pockets = _dots(0.0052, height + 0.0010, seeds, ring(6, 0.0135))
    return disc(radius, height, skin) + disc(radius - 0.003, height + 0.0005, flesh) + pockets


def _onion(radius: float, height: float, colours: list[str]) -> str:
    skin, white, violet = colours
    rings = ((0.0, skin), (0.0045, white), (0.009, violet), (0.012, white), (0.019, violet))
    return "".join(
        disc(radius - inset, height + 0.0004 * step, rgba, detail=step > 3)
        for step, (inset, rgba) in enumerate(rings)
    )
