"""Draw: pictures for people, in a process of their own beside the robots.

Drawing in software takes more of a processor than a robot does. In a thread it would also hold
Python's lock now and then: robots would wait for it, and at a low priority for as long as others
keep that thread from its work. A process may be as patient as it likes.
"""

import contextlib
import json
import os
import subprocess
import sys
import threading
import time
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from services.actor.kinds import make_robot
from shared.errors import NoAnswerError
from shared.rollout.robot import Photographer

NICE = 10  # Below the robots: they first. Lower, hardly a picture comes where all is busy.
AGAIN_S = 5.0  # From one start to the next: a machine that can't draw isn't kept busy with trying.


class Drawer:
    """One process that draws for all robots of an actor; started at the first picture.

    kind, site, skills: what robots they are, see `make_robot`.
    """

    def __init__(self, kind: str, site: str, skills: int | None = None) -> None:
        self._robots = json.dumps({"kind": kind, "site": site, "skills": skills})
        self._lock = threading.Lock()
        self._child: subprocess.Popen[bytes] | None = None
        self._started_s = -AGAIN_S
        self._closed = False

    def photographer(self) -> Photographer:
        """Whom one robot asks for its pictures, from any thread."""
        return _Asking(self)

    def picture(
        self, snapshot: NDArray[np.float64], camera: str, width: int, height: int
    ) -> NDArray[np.uint8]:
        """What `camera` sees at a `snapshot`, [height, width, 3] uint8; one at a time.

        Raises:
            NoAnswerError: the process died, or was closed; it is started again in a while.
        """
        head = {"camera": camera, "width": width, "height": height, "values": snapshot.size}
        with self._lock:
            child = self._running()
            assert child.stdin
            assert child.stdout
            try:
                child.stdin.write(json.dumps(head).encode() + b"\n")
                child.stdin.write(np.ascontiguousarray(snapshot, np.float64).tobytes())
                child.stdin.flush()
                pixels = _read(child.stdout, width * height * 3)
            except (OSError, ValueError) as error:
                raise NoAnswerError(f"the process that draws is gone: {error}") from None
        return np.frombuffer(pixels, np.uint8).reshape(height, width, 3)

    def close(self) -> None:
        """Draw nothing more; who waits for a picture gets none."""
        self._closed = True
        if self._child:
            self._child.kill()  # It keeps nothing, and may be far from its next turn.
            _bury(self._child)

    def _running(self) -> "subprocess.Popen[bytes]":
        if self._child and self._child.poll() is None:
            return self._child
        if self._closed or time.monotonic() < self._started_s + AGAIN_S:
            raise NoAnswerError("nobody draws")
        self._started_s = time.monotonic()
        if self._child:
            _bury(self._child)
        self._child = subprocess.Popen(
            [sys.executable, "-m", "services.actor.draw", self._robots],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            process_group=0,  # Ctrl-C is for the actor. Niceness may count within a session alone.
        )
        return self._child


class _Asking:
    """A robot's photographer, who has it drawn elsewhere."""

    def __init__(self, drawer: Drawer) -> None:
        self._drawer = drawer

    def picture(self, snapshot: Any, camera: str, width: int, height: int) -> NDArray[np.uint8]:
        return self._drawer.picture(snapshot, camera, width, height)

    def close(self) -> None:
        """Nothing of one's own is open."""


def _bury(child: "subprocess.Popen[bytes]") -> None:
    child.wait()
    for pipe in (child.stdin, child.stdout):
        with contextlib.suppress(OSError):  # What was not written yet will not be.
            if pipe:
                pipe.close()


def _read(pipe: IO[bytes], size: int) -> bytes:
    """Raises: ValueError: the other side closed it before."""
    found = pipe.read(size)
    if len(found) < size:
        raise ValueError(f"{len(found)} of {size} bytes came")
    return found


def main() -> None:
    """Draw what is asked for on standard input, until that is closed."""
    os.nice(NICE)
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # Whatever a library prints is no picture.
    robot = make_robot(**json.loads(sys.argv[1]))
    photographer = robot.photographer()
    asked = sys.stdin.buffer
    while line := asked.readline():
        head = json.loads(line)
        snapshot = np.frombuffer(_read(asked, 8 * head.pop("values")), np.float64)
        picture = photographer.picture(snapshot, **head)
        answers.write(np.ascontiguousarray(picture, np.uint8).tobytes())
        answers.flush()
    photographer.close()
    robot.close()


if __name__ == "__main__":
    main()
