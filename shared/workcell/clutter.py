"""Distractors: things that lie around a cell and belong to no task. Seen, never touched."""

_THINGS = (
    ("cylinder", ".030 .022", "-.47 -.27 .022", ".85 .55 .12 1"),
    ("box", ".050 .034 .008", ".47 .30 .008", ".20 .62 .30 1"),
    ("box", ".036 .052 .004", "-.46 .29 .004", ".95 .94 .90 1"),
    ("cylinder", ".022 .040", ".48 -.26 .040", ".62 .14 .16 1"),
    ("box", ".060 .010 .006", ".10 -.34 .006", ".12 .12 .14 1"),
    ("cylinder", ".034 .010", "-.14 -.345 .010", ".22 .30 .72 1"),
    ("box", ".024 .024 .024", ".20 .365 .024", ".90 .82 .16 1"),
    ("sphere", ".026", "-.22 .36 .026", ".72 .74 .78 1"),
)
MOST = len(_THINGS)


def clutter_xml(count: int) -> str:
    """The first `count` distractors as MJCF geoms, beside the tray."""
    return "".join(
        f'<geom class="look" type="{kind}" size="{size}" pos="{at}" rgba="{rgba}"/>'
        for kind, size, at, rgba in _THINGS[:count]
    )
