"""What an experiment found: figures for machines, tables and curves for people; pure data."""

from typing import Any

from shared.config import Settings


class Table(Settings):
    """columns: their heads. rows: cells as they are shown."""

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


class Curve(Settings):
    """Rates over something, each with its interval.

    x: numbers, or names that are set out evenly. dashed: it is computed, not measured.
    """

    label: str
    x: tuple[float, ...] | tuple[str, ...]
    y: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    dashed: bool = False


class Panel(Settings):
    """Curves over one another. x_label: where it isn't that of the plot."""

    title: str
    curves: tuple[Curve, ...]
    x_label: str | None = None


class Plot(Settings):
    """One picture: panels beside one another. name: of its file, without the suffix."""

    name: str
    title: str
    x_label: str
    panels: tuple[Panel, ...]
    y_label: str = "success"


class Findings(Settings):
    """What came out.

    title: one line. method: what was done, in sentences. figures: rates as `rate` gives them, and
    what was computed from them. first: names of the figures that stand at the top of report.json
    as well. notes: what one must know to read them.
    """

    title: str
    method: tuple[str, ...]
    figures: dict[str, Any]
    first: tuple[str, ...] = ()
    tables: tuple[Table, ...] = ()
    plots: tuple[Plot, ...] = ()
    notes: tuple[str, ...] = ()


def cell(figures: dict[str, Any]) -> str:
    """A rate as a cell of a table: 0.83 (0.72 to 0.90)."""
    low, high = figures["interval"]
    return f"{figures['success']:.2f} ({low:.2f} to {high:.2f})"


def gap_cell(figures: dict[str, Any]) -> str:
    """A paired difference as a cell of a table: +0.12 (+0.02 to +0.21), p = 0.031."""
    low, high = figures["interval"]
    p = f"p = {figures['p']:.3f}" if figures["p"] >= 0.001 else "p < 0.001"
    return f"{figures['difference']:+.2f} ({low:+.2f} to {high:+.2f}), {p}"


def curve(label: str, points: dict[float, dict[str, Any]] | dict[str, dict[str, Any]]) -> Curve:
    """A curve through rates by x."""
    rates = list(points.values())
    return Curve(
        label=label,
        x=tuple(points),
        y=tuple(rate["success"] for rate in rates),
        low=tuple(rate["interval"][0] for rate in rates),
        high=tuple(rate["interval"][1] for rate in rates),
    )
