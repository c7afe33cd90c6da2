"""How dishes and rubbish look. Sizes: objects.py. Blocks lie with their length along y."""

from shared.workcell.objects import Object
from shared.workcell.shapes import Look, disc, dots, geom, ring, rounded
from shared.workcell.site import Colour

COLOURS: dict[str, tuple[Colour, ...]] = {
    "cup": ((0.86, 0.12, 0.12), (0.40, 0.05, 0.06), (0.96, 0.42, 0.38)),
    "bowl": ((0.14, 0.34, 0.86), (0.42, 0.60, 0.98), (0.10, 0.22, 0.60)),
    "glass": ((0.30, 0.78, 0.48), (0.70, 0.95, 0.80), (0.16, 0.50, 0.30)),
    "saucer": ((0.95, 0.95, 0.94), (0.99, 0.99, 0.99), (0.76, 0.77, 0.79)),
    "can": ((0.84, 0.10, 0.10), (0.80, 0.81, 0.83), (0.97, 0.97, 0.97)),
    "wrapper": ((0.98, 0.82, 0.10), (0.80, 0.60, 0.04), (0.99, 0.94, 0.60)),
    "carton": ((0.16, 0.40, 0.84), (0.94, 0.95, 0.97), (0.62, 0.74, 0.94)),
    "napkin": ((0.97, 0.97, 0.96), (0.86, 0.87, 0.88), (0.80, 0.82, 0.86)),
}
_ALONG_Y = 'euler="1.5707963 0 0"'


def _barrel(radius: float, half: float, rgba: str, y: float = 0.0, detail: bool = False) -> str:
    """A cylinder that lies along y."""
    return geom("cylinder", f"{radius} {half}", rgba, f"0 {y} 0", detail, _ALONG_Y)


def _cup(item: Object, colours: list[str]) -> str:
    body, inside, handle = colours
    width, length, _ = item.half_sizes_m
    ear = geom("box", f".003 .011 {width * 0.3}", handle, f"{width + 0.004} -.002 0")
    return (
        _barrel(width, length, body)
        + _barrel(width * 0.8, 0.0008, inside, length)
        + _barrel(width * 1.01, 0.002, handle, length - 0.003, detail=True)
        + ear
    )


def _dish(item: Object, colours: list[str], rim: float, middle: float) -> str:
    """A round dish; the shares of its radius at which the rim ends and the middle begins."""
    body, inside, edge = colours
    radius, _, height = item.half_sizes_m
    return (
        disc(radius, height, body)
        + disc(radius * rim, 0.0005, edge, f"0 0 {height}")
        + disc(radius * middle, 0.0005, inside, f"0 0 {height + 0.0003}")
    )


def _bowl(item: Object, colours: list[str]) -> str:
    return _dish(item, colours, 0.82, 0.68)


def _saucer(item: Object, colours: list[str]) -> str:
    return _dish(item, colours, 0.62, 0.52)


def _glass(item: Object, colours: list[str]) -> str:
    body, bright, dark = colours
    width, length, _ = item.half_sizes_m
    return (
        _barrel(width, length * 0.82, body, -0.18 * length)
        + _barrel(width * 1.02, length * 0.18, bright, 0.82 * length)
        + _barrel(width * 0.8, 0.0008, dark, length)
    )


def _can(item: Object, colours: list[str]) -> str:
    body, metal, stripe = colours
    width, length, _ = item.half_sizes_m
    ends = "".join(_barrel(width * 0.94, 0.003, metal, side * (length - 0.003)) for side in (-1, 1))
    return _barrel(width, length - 0.005, body) + ends + _barrel(width * 1.01, 0.006, stripe)


def _wrapper(item: Object, colours: list[str]) -> str:
    body, twist, stripe = colours
    width, length, height = item.half_sizes_m
    tails = "".join(
        geom("box", f"{width} {length * 0.16} {height * 0.4}", twist, f"0 {side * length * 0.84} 0")
        for side in (-1, 1)
    )
    middle = geom("box", f"{width * 0.8} {length * 0.68} {height}", body)
    return middle + tails + geom("box", f"{width * 0.82} .004 {height * 1.04}", stripe)


def _carton(item: Object, colours: list[str]) -> str:
    body, label, edge = colours
    width, length, height = item.half_sizes_m
    return (
        geom("box", f"{width} {length * 0.86} {height}", body, f"0 {-0.14 * length} 0")
        + geom("box", f"{width} {length * 0.14} {height * 0.7}", edge, f"0 {0.86 * length} 0")
        + geom("box", f"{width * 0.55} {length * 0.4} {height + 0.0006}", label)
    )


def _napkin(item: Object, colours: list[str]) -> str:
    cloth, fold, pattern = colours
    half, _, height = item.half_sizes_m
    across = geom("box", f"{half} .0012 {height + 0.0006}", fold)
    spots = dots(0.003, height + 0.0007, pattern, ring(4, half * 0.6))
    return rounded(half, height, 0.002, cloth) + across + spots


LOOKS: dict[str, Look] = {
    "cup": _cup,
    "bowl": _bowl,
    "glass": _glass,
    "saucer": _saucer,
    "can": _can,
    "wrapper": _wrapper,
    "carton": _carton,
    "napkin": _napkin,
}
