"""Time as a part that can be replaced: services read the clock that they are given."""

import time
from typing import Protocol


class Clock(Protocol):
    """Where a service reads the time and waits for it."""

    def now_ns(self) -> int:
        """Wall-clock time since the epoch, in nanoseconds: for records that people read."""
        ...

    def monotonic_ns(self) -> int:
        """Time that never goes back, in nanoseconds: for durations and deadlines."""
        ...

    def sleep_ns(self, duration_ns: int) -> None:
        """Wait; a duration of zero or less returns at once."""
        ...


class SystemClock:
    """The machine's own clock."""

    def now_ns(self) -> int:
        return time.time_ns()

    def monotonic_ns(self) -> int:
        return time.monotonic_ns()

    def sleep_ns(self, duration_ns: int) -> None:
        if duration_ns > 0:
            time.sleep(duration_ns / 1e9)


class ManualClock:
    """A clock that a test owns: it moves when it is told to, and when somebody sleeps."""

    def __init__(self, start_ns: int = 1_000_000_000) -> None:
        self._time_ns = start_ns

    def now_ns(self) -> int:
        return self._time_ns

    def monotonic_ns(self) -> int:
        return self._time_ns

    def sleep_ns(self, duration_ns: int) -> None:
        self.advance(max(0, duration_ns))

    def advance(self, duration_ns: int) -> None:
        """Let `duration_ns` pass."""
        self._time_ns += duration_ns
