"""How long work tells how far it is: a bar each on a terminal, else a line now and then."""

import time
from collections.abc import Callable

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

EVERY_S = 10.0
"""From line to line, where nobody looks at a terminal."""


class Bars:
    """To be closed once the work is over, as by `contextlib.closing`."""

    def __init__(self, console: Console) -> None:
        columns = TextColumn("{task.description:28}"), BarColumn(), MofNCompleteColumn()
        self._console = console
        self._progress = Progress(
            *columns, TimeRemainingColumn(), console=console, disable=not console.is_terminal
        )
        self._progress.start()

    def close(self) -> None:
        """Draw no more."""
        self._progress.stop()

    def stage(self, name: str, total: int) -> Callable[[int], None]:
        """Begin something; the answer is to be told how much of `total` is done."""
        if not self._console.is_terminal:
            return _Lines(self._console, name, total)
        task = self._progress.add_task(name, total=total)
        return lambda done: self._progress.update(task, completed=done)

    def __call__(self, name: str, total: int) -> Callable[[], None]:
        """Begin something; the answer is to be called for each part of `total` that is done."""
        tell, done = self.stage(name, total), 0

        def one_more() -> None:
            nonlocal done
            done += 1
            tell(done)

        return one_more


class _Lines:
    """Tells every `EVERY_S`, and at the end."""

    def __init__(self, console: Console, name: str, total: int) -> None:
        self._console, self._name, self._total = console, name, total
        self._began = self._told = time.monotonic()

    def __call__(self, done: int) -> None:
        now = time.monotonic()
        if done < self._total and now - self._told < EVERY_S:
            return
        self._told = now
        line = f"{self._name}: {done} of {self._total}, {now - self._began:.0f} s"
        self._console.print(line, markup=False, highlight=False, soft_wrap=True)
