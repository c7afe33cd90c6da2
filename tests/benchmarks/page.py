"""What it costs the robots that somebody looks: `make bench-page`.

One actor process with robots in real time, or one for each, the API, and Chromium with the page
open or closed, in turn. The browser of a lab is another machine's: here it yields to the robots, in
a scheduling group of its own and without the right to raise its priority, as Chromium else does.
Figures are printed and judged by nobody: they hold for this machine and what else it does.
"""

import argparse
import json
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from deploy.system import find_browser
from tests.integration.correction_api.browsing import launched
from tests.integration.correction_api.processes import Cell
from tests.integration.correction_api.visiting import visited

YIELDING = """#!/bin/sh
echo 19 > /proc/self/autogroup
exec setpriv --bounding-set -sys_nice --inh-caps -sys_nice nice -n 19 {browser} "$@"
"""
"""Starts the browser so that it yields: it has a session of its own, so niceness is not enough."""
SETTLE_S = 5.0
DRAWN_WITHIN_MS = 180_000  # On a machine that is too slow for this, the figures say so.
TALL = (1440, 2400)  # All robots are in view.


class Span(NamedTuple):
    """The control loop over a while: turns a second, the share that was late, and pictures/s."""

    hz: float
    late: float
    pictures: float


def main() -> None:
    """Measure closed and open in turn, and print the ratio."""
    options = _options()
    with tempfile.TemporaryDirectory() as folder:
        frames = dict.fromkeys(options.rates, options.hz)
        actor = {f"frames__{name}": value for name, value in frames.items()}
        with Cell(Path(folder), options.robots, actor, options.apart) as cell:
            browser = Path(folder) / "browser"
            browser.write_text(YIELDING.format(browser=find_browser()))
            browser.chmod(0o700)
            for again in range(options.times):
                closed = _measure(cell, options.seconds)
                with _looked_at(cell, browser):
                    opened = _measure(cell, options.seconds)
                print(_line(options.robots, again, closed, opened), flush=True)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--apart", action="store_true", help="a process for each robot")
    parser.add_argument("--robots", type=int, default=8)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--times", type=int, default=2)
    parser.add_argument("--hz", type=float, default=10.0, help="pictures a second of each camera")
    parser.add_argument("--rates", nargs="*", default=["rate_hz", "slow_hz"])
    return parser.parse_args()


@contextmanager
def _looked_at(cell: Cell, path: Path) -> Iterator[None]:
    with launched(path) as browser, visited(browser, cell.url, TALL) as page:
        page.locator("canvas.drawn").first.wait_for(timeout=DRAWN_WITHIN_MS)
        yield


def _measure(cell: Cell, seconds: float) -> Span:
    time.sleep(SETTLE_S)
    began, pictures = time.monotonic(), cell.figure("hldagger_frames_total")
    before = [len(_reports(log)) for log in cell.logs]
    time.sleep(seconds)
    took = time.monotonic() - began
    shown = cell.figure("hldagger_frames_total") - pictures
    reports = [
        report
        for log, some in zip(cell.logs, before, strict=True)
        for report in _reports(log)[some:]
    ]
    turns = sum(report["turns"] for report in reports)
    late = sum(report["late"] for report in reports)
    lasted = sum(report["lasted_s"] for report in reports)
    return Span(turns / lasted, late / turns, shown / took)


def _reports(log: Path) -> list[dict[str, float]]:
    """What the control loop told of itself, each 10 s."""
    lines = (json.loads(line) for line in log.read_text().splitlines() if line.startswith("{"))
    return [line for line in lines if line.get("event") == "control loop"]


def _line(robots: int, again: int, closed: Span, opened: Span) -> str:
    return (
        f"{robots} robots, {again + 1}: closed {closed.hz:.2f} Hz, {closed.late:.1%} late; "
        f"open {opened.hz:.2f} Hz, {opened.late:.1%} late, {opened.pictures:.0f} pictures/s; "
        f"ratio {opened.hz / closed.hz:.3f}"
    )


if __name__ == "__main__":
    main()
