"""Understand: what would this robot make of a phrase? Asked while a person still types.

The control thread only hands out what the robot senses; the phrase is read on the bus thread, since
the words of a new one take as long as two control steps. Nothing is obeyed.
"""

import os
import sys
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from concurrent.futures import TimeoutError as FutureTimeout
from typing import NamedTuple, Protocol

from shared.errors import MessageError, RefusedError
from shared.messages.goal import Goal
from shared.messages.phrase import Near, PhraseAnswer, PhraseQuestion
from shared.rollout.robot import Floats, Senses
from shared.wire.bus import Bus
from shared.wire.codec import decode, encode
from shared.wire.keys import robot_key

SENSED_WITHIN_S = 1.0
NICE = 10


class Reads(Protocol):
    """A low level that can tell what it understands; every call may come from any thread."""

    sha256: str

    def anywhere(self) -> tuple[Floats, Floats]:
        """Proprioception and objects where everything is there that a scene can have."""
        ...

    def objection(self, proprioception: Floats, objects: Floats, goal: Goal) -> str:
        """Why it can't do it now; "" if it can."""
        ...

    def nearest(
        self, proprioception: Floats, objects: Floats, goal: Goal
    ) -> Sequence[tuple[str, float]]:
        """The possible commands that a goal is nearest to, with their scores, best first."""
        ...

    def meaning(self, goal: Goal, objects: Floats) -> str | None:
        """The command that it takes a goal for; None if it understands none."""
        ...

    def commands(self, objects: Floats) -> Sequence[str]:
        """What it knows and could do with what is in the scene."""
        ...


class Moment(NamedTuple):
    """What a robot senses, and at which control step."""

    senses: Senses
    step: int


class Listener:
    """Answers for one robot; its control thread calls `offer` at each turn."""

    def __init__(self, bus: Bus, fleet: str, robot: str, low_level: Reads) -> None:
        self._robot, self._low_level = robot, low_level
        self._wanted: Future[Moment] | None = None
        self._lock = threading.Lock()
        self._yielded = False
        key = robot_key(fleet, robot, "phrase")
        self._subscription = bus.serve(key, self._answer, capacity=8)

    def offer(self, sense: Callable[[], Moment | None]) -> None:
        """In the control thread: hand out this moment if somebody wants to know; never waits.

        sense: None between two episodes.
        """
        if self._wanted is None:
            return
        with self._lock:
            wanted, self._wanted = self._wanted, None
        if wanted is not None and (moment := sense()) is not None:
            wanted.set_result(moment)
        elif wanted is not None:
            wanted.set_exception(RefusedError("between two episodes; ask again in a moment"))

    def close(self) -> None:
        """Answer nobody any more."""
        self._subscription.close()

    def _answer(self, key: str, payload: bytes) -> bytes:
        del key  # Unused: the key is this robot's.
        self._yield()
        question = decode(PhraseQuestion, payload)
        if question.robot != self._robot:
            raise MessageError(f"a question about {question.robot} came to {self._robot}")
        if question.anywhere:
            return encode(self._read_anywhere(question.text))
        return encode(self._read(question.text, self._moment()))

    def _yield(self) -> None:
        """The robot goes first: on Linux a thread has a priority of its own."""
        if not self._yielded and sys.platform == "linux":
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), NICE)
        self._yielded = True

    def _moment(self) -> Moment:
        wanted: Future[Moment] = Future()
        with self._lock:
            self._wanted = wanted
        try:
            return wanted.result(SENSED_WITHIN_S)
        except FutureTimeout:
            raise RefusedError("the control loop of this robot stands still") from None

    def _read_anywhere(self, text: str | None) -> PhraseAnswer:
        """Whether a phrase is understood at all: what is not there is no reason against it."""
        moment = Moment(Senses(*self._low_level.anywhere()), 0)
        if text is None:
            return self._read(None, moment)
        means = self._low_level.meaning(Goal(text=text), moment.senses.objects)
        read = self._read(text, moment)
        return read.model_copy(update={"means": means, "refused": "" if means else read.refused})

    def _read(self, text: str | None, moment: Moment) -> PhraseAnswer:
        senses, low_level = moment.senses, self._low_level
        commands = tuple(low_level.commands(senses.objects))
        told = {"robot": self._robot, "step": moment.step, "low_level_sha256": low_level.sha256}
        if text is None:
            return PhraseAnswer(**told, commands=commands)
        goal = Goal(text=text)
        refused = low_level.objection(*senses, goal)
        near = low_level.nearest(*senses, goal)
        return PhraseAnswer(
            **told,
            text=text,
            means=None if refused else low_level.meaning(goal, senses.objects),
            refused=refused,
            known=goal.text in commands,
            nearest=tuple(Near(command=one, score=min(1.0, max(0.0, by))) for one, by in near),
        )
