"""How the food looks. Sizes: objects.py."""

from shared.workcell.objects import Object
from shared.workcell.shapes import Look, disc, dots, geom, ring, rounded
from shared.workcell.site import Colour

COLOURS: dict[str, tuple[Colour, ...]] = {
    "bread": ((0.80, 0.56, 0.30), (0.97, 0.89, 0.72)),
    "toast": ((0.36, 0.19, 0.08), (0.62, 0.36, 0.15)),
    "cheese": ((1.00, 0.80, 0.12), (0.93, 0.66, 0.05)),
    "ham": ((0.96, 0.66, 0.68), (0.90, 0.47, 0.54), (0.97, 0.76, 0.76)),
    "lettuce": ((0.30, 0.66, 0.16), (0.46, 0.80, 0.26), (0.66, 0.88, 0.44)),
    "tomato": ((0.82, 0.10, 0.07), (0.93, 0.22, 0.14), (0.98, 0.55, 0.22)),
    "onion": ((0.50, 0.16, 0.46), (0.93, 0.88, 0.93), (0.70, 0.42, 0.68)),
}


def _loaf(item: Object, colours: list[str]) -> str:
    half, height = item.half_width_m, item.half_height_m
    crust, crumb = colours
    inner = rounded(half - 0.0045, height + 0.0006, 0.007, crumb)
    return rounded(half, height, 0.009, crust) + inner


def _cheese(item: Object, colours: list[str]) -> str:
    half, height = item.half_width_m, item.half_height_m
    holes = ((0.010, 0.012, 0.005), (-0.012, 0.004, 0.0065), (0.006, -0.012, 0.004))
    holed = "".join(dots(r, height + 0.0004, colours[1], [f"{x} {y} 0"]) for x, y, r in holes)
    return rounded(half, height, 0.003, colours[0]) + holed


def _ham(item: Object, colours: list[str]) -> str:
    half, height = item.half_width_m, item.half_height_m
    rind, meat, fat = colours
    inner = rounded(half - 0.003, height + 0.0006, 0.014, meat)
    streaks = dots(0.0028, height + 0.0010, fat, ring(5, 0.013, 0.4))
    return rounded(half, height, 0.016, rind) + inner + streaks


def _lettuce(item: Object, colours: list[str]) -> str:
    radius, height = item.half_width_m, item.half_height_m
    dark, leaf, vein = colours
    frill = "".join(
        geom("ellipsoid", f"0.009 0.009 {height}", dark, at, detail=True)
        for at in ring(9, radius - 0.006)
    )
    edge = disc(radius - 0.001, height - 0.002, dark)
    ribs = dots(0.0026, height + 0.0012, vein, [*ring(6, 0.012, 0.3), "0 0 0"])
    return edge + frill + disc(radius - 0.005, height, leaf) + ribs


def _tomato(item: Object, colours: list[str]) -> str:
    radius, height = item.half_width_m, item.half_height_m
    skin, flesh, seeds = colours
    pockets = dots(0.0052, height + 0.0010, seeds, ring(6, 0.0135))
    return disc(radius, height, skin) + disc(radius - 0.003, height + 0.0005, flesh) + pockets


def _onion(item: Object, colours: list[str]) -> str:
    radius, height = item.half_width_m, item.half_height_m
    skin, white, violet = colours
    rings = ((0.0, skin), (0.0045, white), (0.009, violet), (0.012, white), (0.019, violet))
    return "".join(
        disc(radius - inset, height + 0.0004 * step, rgba, detail=step > 3)
        for step, (inset, rgba) in enumerate(rings)
    )


LOOKS: dict[str, Look] = {
    "bread": _loaf,
    "toast": _loaf,
    "cheese": _cheese,
    "ham": _ham,
    "lettuce": _lettuce,
    "tomato": _tomato,
    "onion": _onion,
}
