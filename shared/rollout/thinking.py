"""How the high level is asked: beside the control loop in real time, in step with it in lockstep.

Both hand out an answer later than the question; the rollout carries on with the command in force.
"""

from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from shared.messages.decision import Proposal
from shared.messages.observation import Observation
from shared.rollout.robot import HighLevel

Proposals = tuple[Proposal, ...]
Pictures = Sequence[NDArray[np.uint8]]


class Thinking(Protocol):
    """One question at a time to the high level."""

    def ask(self, high_level: HighLevel, observation: Observation, past: Pictures) -> None:
        """Put the question; an earlier one that was not answered is forgotten.

        past: as in `HighLevel.propose`.
        """
        ...

    def answer(self, step: int) -> Proposals | None:
        """The answer, if it has come by control step `step`."""
        ...

    def close(self) -> None:
        """Stop thinking."""
        ...


class Lockstep:
    """The answer comes a fixed number of control steps after the question, whatever the machine."""

    def __init__(self, latency_steps: int = 0) -> None:
        self._latency_steps = latency_steps
        self._due_step = 0
        self._proposals: Proposals | None = None

    def ask(self, high_level: HighLevel, observation: Observation, past: Pictures) -> None:
        self._proposals = high_level.propose(observation, past)
        self._due_step = observation.step + self._latency_steps

    def answer(self, step: int) -> Proposals | None:
        if self._proposals is None or step < self._due_step:
            return None
        proposals, self._proposals = self._proposals, None
        return proposals

    def close(self) -> None:
        self._proposals = None


class Beside:
    """The answer comes when the high level is ready; it runs in a thread of its own."""

    def __init__(self) -> None:
        self._pool = ThreadPoolExecutor(max_workers=1, thread_name_prefix="high-level")
        self._future: Future[Proposals] | None = None

    def ask(self, high_level: HighLevel, observation: Observation, past: Pictures) -> None:
        if self._future:
            self._future.cancel()
        self._future = self._pool.submit(high_level.propose, observation, past)

    def answer(self, step: int) -> Proposals | None:
        del step  # Unused: real time does not count in steps.
        if self._future is None or not self._future.done():
            return None
        future, self._future = self._future, None
        return future.result()

    def close(self) -> None:
        self._pool.shutdown(wait=True, cancel_futures=True)
