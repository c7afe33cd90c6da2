"""Curves with their intervals, as SVG; drawn from findings alone."""

from itertools import cycle
from pathlib import Path
from typing import Any

from services.learner.experiments.findings import Curve, Panel, Plot

COLOURS = ("#1f5fa8", "#c0562b", "#2e8b57", "#7a4fa3", "#8a7a2a", "#555555")
WIDTH_IN, HEIGHT_IN, NAME_IN = 4.6, 3.6, 0.36
APART = 0.008
"""From one curve to the next, as a share of the axis."""
CROWD = 5
"""More names than this don't fit beside one another."""


def draw(folder: Path, plot: Plot) -> str:
    """Write the picture into `folder`; its file's name."""
    import matplotlib  # Late: it takes a second.
    from matplotlib.figure import Figure

    # No dates and fixed ids, so that equal findings give equal files.
    with matplotlib.rc_context({"svg.hashsalt": plot.name}):
        count = len(plot.panels)
        most = max(len(_places(panel)) for panel in plot.panels)
        size = count * max(WIDTH_IN, NAME_IN * most), HEIGHT_IN
        figure = Figure(figsize=size, layout="constrained")
        for axes, panel in zip(
            figure.subplots(1, count, squeeze=False)[0], plot.panels, strict=True
        ):
            _panel(axes, panel, plot)
        if count > 1:
            figure.suptitle(plot.title)
        name = f"{plot.name}.svg"
        figure.savefig(folder / name, metadata={"Date": None}, bbox_inches="tight")
    return name


def _panel(axes: Any, panel: Panel, plot: Plot) -> None:
    names = _places(panel)
    named = any(isinstance(name, str) for name in names)
    # Intervals at one place would lie upon each other.
    apart = 0.15 if named else APART * _span(names)
    colours: dict[str, str] = {}
    fresh = cycle(COLOURS)
    for place, curve in enumerate(panel.curves):
        # What is computed has the colour of what it was computed from, which comes before it.
        colour = colours[curve.label] = next(fresh) if not curve.dashed else _last(colours)
        shift = apart * (place - (len(panel.curves) - 1) / 2)
        x = [names.index(at) + shift if named else float(at) + shift for at in curve.x]
        _curve(axes, curve, x, colour, named)
    slanted = named and len(names) > CROWD
    if named:
        slant = {"rotation": 35, "ha": "right"} if slanted else {}
        axes.set_xticks(range(len(names)), names, **slant)
    else:
        axes.set_xticks(names, [f"{name:g}" for name in names])
    label = plot.x_label if panel.x_label is None else panel.x_label
    axes.set(ylim=(-0.03, 1.03), xlabel=label, ylabel=plot.y_label, title=panel.title)
    axes.spines[["top", "right"]].set_visible(False)
    if len(panel.curves) > 1:  # Below, where it covers nothing.
        below = 0.5, -0.45 if slanted else -0.2
        axes.legend(
            loc="upper center", bbox_to_anchor=below, ncols=2, frameon=False, fontsize="small"
        )


def _places(panel: Panel) -> list[Any]:
    """All that there is along x, in order, once."""
    return list(dict.fromkeys(x for curve in panel.curves for x in curve.x))


def _span(names: list[Any]) -> float:
    return float(max(names) - min(names)) if names else 0.0


def _last(colours: dict[str, str]) -> str:
    return next(reversed(colours.values()), COLOURS[-1])


def _curve(axes: Any, curve: Curve, x: list[float], colour: str, points: bool) -> None:
    if curve.dashed:
        axes.plot(x, curve.y, "--", color=colour, lw=1.2, label=curve.label)
        axes.fill_between(x, curve.low, curve.high, color=colour, alpha=0.12, lw=0)
        return
    below = [y - low for y, low in zip(curve.y, curve.low, strict=True)]
    above = [high - y for y, high in zip(curve.y, curve.high, strict=True)]
    error = [[max(0.0, one) for one in side] for side in (below, above)]
    form = "o" if points else "o-"
    axes.errorbar(x, curve.y, yerr=error, fmt=form, color=colour, capsize=3, label=curve.label)
