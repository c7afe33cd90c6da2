"""Long work tells how far it is, also where nobody looks at a terminal."""

from contextlib import closing
from io import StringIO
from itertools import count

from rich.console import Console

from shared import progress
from shared.progress import Bars


def test_without_a_terminal_it_is_a_line_now_and_then_and_at_the_end(monkeypatch):
    clock, file = count(step=3), StringIO()  # Three seconds from one look at it to the next.
    monkeypatch.setattr(progress.time, "monotonic", lambda: next(clock))
    with closing(Bars(Console(file=file))) as bars:
        tell = bars("episodes", 9)
        for _ in range(9):
            tell()
    assert file.getvalue().splitlines() == [
        "episodes: 4 of 9, 12 s",
        "episodes: 8 of 9, 24 s",
        "episodes: 9 of 9, 27 s",
    ]


def test_on_a_terminal_it_is_a_bar():
    file = StringIO()
    with closing(Bars(Console(file=file, force_terminal=True, width=100))) as bars:
        tell = bars.stage("training", 40)
        tell(40)
    assert "training" in file.getvalue()
    assert "40/40" in file.getvalue()
    assert "40 of 40" not in file.getvalue()
