"""The seams of the rollout: what a robot, a high level and a low level must be able to do.

A robot of your own, real or simulated, implements `Robot`; nothing else in the loop knows it.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from shared.messages.decision import Proposal
from shared.messages.goal import Goal
from shared.messages.observation import Observation
from shared.messages.policy import Version

Floats = NDArray[np.float32]


class Scene(NamedTuple):
    """What an episode is about, as told by the robot when it was reset.

    steps: control steps that an attempt at it deserves.
    """

    task: str
    prompt: str
    site: str
    steps: int = 900


class Senses(NamedTuple):
    """What the low level feels at one control step.

    proprioception: [P] float32; objects: [N, 9] float32; both as in `Observation`.
    """

    proprioception: Floats
    objects: Floats


class Robot(Protocol):
    """One robot in its cell. All calls but `photographer` come from one thread."""

    action_size: int

    def reset(self, seed: int, task: str, prompt: str | None) -> Scene:
        """Begin an episode; equal seeds give equal scenes. `prompt` None: the robot draws one."""
        ...

    def sense(self) -> Senses:
        """What the low level is to know now."""
        ...

    def look(self) -> NDArray[np.uint8]:
        """The pictures for the high level, [V, 64, 64, 3] uint8."""
        ...

    def snapshot(self) -> Any:
        """This moment, as a photographer needs it; cheap, since the control loop waits for it."""
        ...

    def photographer(self) -> "Photographer":
        """Who makes pictures for people; made in, used in and closed in a thread of its own."""
        ...

    def truth(self) -> dict[str, Any]:
        """The simulator's account of the scene as JSON values; a real robot returns {}."""
        ...

    def step(self, action: NDArray[np.float64]) -> bool:
        """Move by one control step; True when the task is done.

        action: [14] joint position targets, rad; grippers in m.
        """
        ...

    def close(self) -> None:
        """Give everything back."""
        ...


class Photographer(Protocol):
    """Makes pictures for people, beside the control loop."""

    def picture(self, snapshot: Any, camera: str, width: int, height: int) -> NDArray[np.uint8]:
        """What `camera` saw at a robot's `snapshot`, [height, width, 3] uint8."""
        ...

    def close(self) -> None:
        """Make no more pictures."""
        ...


class HighLevel(Protocol):
    """The slow policy that chooses goals."""

    version: Version

    def propose(
        self, observation: Observation, past: Sequence[NDArray[np.uint8]] = ()
    ) -> tuple[Proposal, ...]:
        """Goals with their scores, best first; called from a thread beside the control loop.

        past: pictures [V, 64, 64, 3] uint8 of earlier decisions of this episode, oldest first;
            fewer at its beginning.
        """
        ...


class PolicySource(Protocol):
    """The narrow view that a robot has of the learner."""

    @property
    def newest(self) -> HighLevel:
        """The newest high level that is whole and verified."""
        ...


class LowLevel(Protocol):
    """The fast policy that turns goal and senses into actions; frozen while the high one learns.

    sha256: over all of its tensors when it was loaded. chunk_steps: how many actions `act` gives
        at once.
    """

    sha256: str
    chunk_steps: int

    def fingerprint(self) -> str:
        """`sha256` computed anew over the tensors as they are in memory now."""
        ...

    def act(self, proprioception: Floats, objects: Floats, goal: Goal) -> Floats:
        """The next action chunk, [chunk_steps, 14].

        Never fails on a goal that it objects to: it does what it understands of it, or stays.
        """
        ...

    def completion(self, proprioception: Floats, objects: Floats, goal: Goal) -> float:
        """The probability, 0 to 1, that the goal is achieved now, by a learned classifier."""
        ...

    def can(self, goal: Goal, objects: Floats) -> bool:
        """Whether it understands the goal and the scene has what it is about.

        Asked of what a high level proposes, at each decision, from the control loop: quick for a
        goal that it was asked before. What is in the hands is of no account, so that a high
        level's mistakes are seen.
        """
        ...

    def objection(self, proprioception: Floats, objects: Floats, goal: Goal) -> str:
        """Why it can't do now what a person says, in a sentence that names the nearest goals that
        it knows; "" if it understands the goal and can.
        """
        ...
