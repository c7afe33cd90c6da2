"""Throttle: pictures yield to the control loop, whose time they take."""

WINDOW_NS = 1_000_000_000
BEHIND = 0.05  # Share of a window: a busy machine loses less than this now and then.
LEAST = 0.1  # Slower pictures would save hardly more, and a person still has to see the robot.
MORE = 0.05


class Throttle:
    """The share of the pictures' rate that a control loop leaves time for, from `LEAST` to 1.

    Halved after a second in which the loop fell behind, a little more after each other one:
    additive increase, multiplicative decrease, as in congestion control (Chiu and Jain 1989).
    """

    def __init__(self) -> None:
        self.share = 1.0
        self._window_ns = self._lost_ns = 0

    def turned(self, took_ns: int, late_ns: int) -> None:
        """One turn of the loop: how long it took with its sleep, and by how much it was late."""
        self._window_ns += took_ns
        self._lost_ns += late_ns
        if self._window_ns < WINDOW_NS:
            return
        behind = self._lost_ns > BEHIND * self._window_ns
        self.share = max(LEAST, self.share / 2) if behind else min(1.0, self.share + MORE)
        self._window_ns = self._lost_ns = 0
