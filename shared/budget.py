"""A budget of what may be done so often within any hour: a window that slides, not a full hour."""

from collections import deque
from collections.abc import Iterable

HOUR_NS = 3_600_000_000_000


class Budget:
    """When it was spent, and whether it may be again. Times are given, so that tests own them."""

    def __init__(self, per_hour: int, spent_ns: Iterable[int] = ()) -> None:
        """per_hour: 0: no limit. spent_ns: what was spent before a restart, oldest first."""
        self._per_hour = per_hour
        self._spent_ns = deque(spent_ns, maxlen=per_hour)

    @property
    def spent_ns(self) -> tuple[int, ...]:
        """When the last ones were spent, oldest first; what a restart must not forget."""
        return tuple(self._spent_ns)

    def spend(self, now_ns: int) -> bool:
        """Spend one if there is one; False: there is none, until an hour after the oldest.

        A clock that was set back neither refills the budget nor blocks it for more than an hour.
        """
        if not self._per_hour:
            return True
        spent = (min(then, now_ns) for then in self._spent_ns)
        self._spent_ns = deque((t for t in spent if now_ns - t < HOUR_NS), maxlen=self._per_hour)
        if len(self._spent_ns) == self._per_hour:
            return False
        self._spent_ns.append(now_ns)
        return True
