"""What every service process does alike: hear SIGINT and SIGTERM, and end in good order."""

import os
import signal
import threading
import time
from collections.abc import Callable
from types import FrameType

import typer

CALLED = "HLD_COMMAND"
"""Environment variable in which `hld` leaves what people typed, such as "hld evaluate"."""


def run_command(main: Callable[..., None]) -> None:
    """Run a module's command; its usage line says how people call it, as `hld` tells."""
    app = typer.Typer(add_completion=False)
    app.command()(main)
    run_app(app)


def run_app(app: typer.Typer) -> None:
    """The same for a module with several commands."""
    app(prog_name=os.environ.pop(CALLED, None))


def die_with_supervisor() -> None:
    """End this process when the one that started it is gone; for work that keeps nothing open."""
    if supervisor := os.environ.get("HLD_SUPERVISOR_PID"):

        def mind() -> None:
            while os.getppid() == int(supervisor):
                time.sleep(1.0)
            os.killpg(os.getpgid(0), signal.SIGTERM)

        threading.Thread(target=mind, daemon=True).start()


def interrupt_at_sigterm() -> None:
    """SIGTERM ends this process as Ctrl-C does, so that it puts its children away."""
    signal.signal(signal.SIGTERM, signal.default_int_handler)


class Stop:
    """Set once, when the process shall end; loops look at it, waits wake up by it."""

    def __init__(self) -> None:
        self._event = threading.Event()

    def __bool__(self) -> bool:
        return self._event.is_set()

    def set(self) -> None:
        """Ask everybody to end."""
        self._event.set()

    def wait(self, timeout_s: float | None = None) -> bool:
        """Sleep until the end or the time-out; True when it is the end."""
        return self._event.wait(timeout_s)

    def on_signals(self) -> "Stop":
        """End at Ctrl-C, at SIGTERM, and when a supervisor is gone (main thread only)."""

        def handle(number: int, frame: FrameType | None) -> None:
            del number, frame  # Unused.
            self.set()

        signal.signal(signal.SIGINT, handle)
        signal.signal(signal.SIGTERM, handle)
        if supervisor := os.environ.get("HLD_SUPERVISOR_PID"):
            threading.Thread(target=self._mind, args=(int(supervisor),), daemon=True).start()
        return self

    def _mind(self, supervisor: int) -> None:
        """Nobody stays behind when the supervisor was killed."""
        while not self.wait(1.0):
            if os.getppid() != supervisor:
                self.set()
