"""Hand-written parts that a rollout can drive: a robot that only counts, policies that only say."""

from collections.abc import Callable, Sequence

import numpy as np

from shared.clock import ManualClock
from shared.messages.correction import Correction, Kind
from shared.messages.decision import Decision, Proposal
from shared.messages.goal import Goal
from shared.messages.observation import Observation
from shared.messages.policy import Version
from shared.rollout.robot import HighLevel, LowLevel, Scene, Senses
from shared.rollout.rollout import Rollout
from shared.rollout.settings import RolloutSettings
from shared.rollout.thinking import Lockstep, Thinking


class CountingRobot:
    """Feels how many steps it has made, and remembers every action."""

    action_size = 14

    def __init__(self, done_at: int = 10**9) -> None:
        self.done_at = done_at
        self.actions: list[np.ndarray] = []

    def reset(self, seed: int, task: str, prompt: str | None) -> Scene:
        del seed
        self.actions.clear()
        return Scene(task, prompt or "do it", "lab")

    def sense(self) -> Senses:
        steps = float(len(self.actions))
        return Senses(np.full(22, steps, np.float32), np.zeros((9, 9), np.float32))

    def look(self) -> np.ndarray:
        return np.full((2, 64, 64, 3), len(self.actions) % 256, np.uint8)

    def snapshot(self) -> int:
        return len(self.actions)

    def photographer(self) -> "CountingRobot":
        return self

    def picture(self, snapshot: int, camera: str, width: int, height: int) -> np.ndarray:
        del snapshot, camera
        return np.zeros((height, width, 3), np.uint8)

    def truth(self) -> dict[str, object]:
        return {}

    def step(self, action: np.ndarray) -> bool:
        self.actions.append(action)
        return len(self.actions) >= self.done_at

    def close(self) -> None:
        pass


class SayingHighLevel:
    """Proposes what it was told to, the same each time or one after the other."""

    version = Version(1, 0)

    def __init__(self, *commands: str) -> None:
        self.commands = list(commands)
        self.seen: list[Observation] = []
        self.past: list[tuple[np.ndarray, ...]] = []

    def propose(
        self, observation: Observation, past: Sequence[np.ndarray] = ()
    ) -> tuple[Proposal, ...]:
        self.seen.append(observation)
        self.past.append(tuple(past))
        first = self.commands[min(len(self.seen), len(self.commands)) - 1]
        return (
            Proposal(goal=Goal(text=first), score=0.7),
            Proposal(goal=Goal(text="something else"), score=0.3),
        )


class EchoingLowLevel:
    """Ten actions that say for which command they are: the length of its text, in every joint."""

    sha256 = "0" * 64
    chunk_steps = 10

    def fingerprint(self) -> str:
        return self.sha256

    def act(self, proprioception: np.ndarray, objects: np.ndarray, goal: Goal) -> np.ndarray:
        del proprioception, objects
        return np.full((10, 14), len(goal.text), np.float32)

    def completion(self, proprioception: np.ndarray, objects: np.ndarray, goal: Goal) -> float:
        del proprioception, objects, goal
        return 0.0

    def can(self, goal: Goal, objects: np.ndarray) -> bool:
        return not self.objection(np.zeros(22), objects, goal)

    def objection(self, proprioception: np.ndarray, objects: np.ndarray, goal: Goal) -> str:
        del proprioception, objects, goal
        return ""

    def nearest(
        self, proprioception: np.ndarray, objects: np.ndarray, goal: Goal
    ) -> list[tuple[str, float]]:
        del proprioception, objects, goal
        return [("left", 0.75), ("right", 0.25)]

    def meaning(self, goal: Goal, objects: np.ndarray) -> str | None:
        del goal, objects
        return "left"

    def anywhere(self) -> tuple[np.ndarray, np.ndarray]:
        return np.zeros(22), np.zeros((18, 9))

    def commands(self, objects: np.ndarray) -> list[str]:
        del objects
        return ["left", "right"]


class KnowingLowLevel(EchoingLowLevel):
    """Knows some commands, and says of a command at a control step whether it is achieved.

    achieved: from step and text to a probability; None: nothing ever is. asked: the steps at
        which it was asked.
    knows: the texts that it doesn't object to; None: all of them.
    """

    def __init__(
        self,
        achieved: Callable[[int, str], float] | None = None,
        knows: Sequence[str] | None = None,
    ) -> None:
        self.achieved, self.knows = achieved, knows
        self.asked: list[int] = []

    def completion(self, proprioception: np.ndarray, objects: np.ndarray, goal: Goal) -> float:
        del objects
        self.asked.append(int(proprioception[0]))
        return self.achieved(self.asked[-1], goal.text) if self.achieved else 0.0

    def objection(self, proprioception: np.ndarray, objects: np.ndarray, goal: Goal) -> str:
        del proprioception, objects
        if self.knows is None or goal.text in self.knows:
            return ""
        return f"I don't know how to {goal.text}; I know: {', '.join(self.knows)}"


class ScoringHighLevel:
    """Proposes two goals with the scores that it was told to, look by look; the last one stays."""

    version = Version(1, 0)

    def __init__(self, *scores: float, first: str = "left", second: str = "rightward") -> None:
        """scores: of `first`; `second` has the rest."""
        self.scores, self.looks = scores, 0
        self.first, self.second = Goal(text=first), Goal(text=second)

    def propose(
        self, observation: Observation, past: Sequence[np.ndarray] = ()
    ) -> tuple[Proposal, ...]:
        del observation, past
        score = self.scores[min(self.looks, len(self.scores) - 1)]
        self.looks += 1
        both = (Proposal(goal=self.first, score=score), Proposal(goal=self.second, score=1 - score))
        return tuple(sorted(both, key=lambda proposal: -proposal.score))


def rollout_of(
    *commands: str,
    robot: CountingRobot | None = None,
    high_level: HighLevel | None = None,
    low_level: LowLevel | None = None,
    thinking: Thinking | None = None,
    decisions: list[Decision] | None = None,
    **settings: object,
) -> Rollout:
    """A rollout over fakes; `settings` as in `RolloutSettings`."""
    return Rollout(
        robot or CountingRobot(),
        high_level or SayingHighLevel(*commands),
        low_level or EchoingLowLevel(),
        thinking or Lockstep(),
        ManualClock(),
        RolloutSettings.model_validate(settings),
        name="robot-1",
        episode="ep-1",
        scene=Scene("pack", "do it", "lab"),
        decided=(decisions if decisions is not None else []).append,
    )


def advance(rollout: Rollout, steps: int) -> None:
    """So many control steps, each of which must be one."""
    for _ in range(steps):
        assert rollout.advance()


def said(kind: Kind, text: str | None = None, **fields: object) -> Correction:
    """A correction of `ep-1`."""
    said.count += 1  # type: ignore[attr-defined]
    head: dict[str, object] = {
        "id": f"co-{said.count}",  # type: ignore[attr-defined]
        "robot": "robot-1",
        "episode": "ep-1",
        "kind": kind,
        "author": "ada",
        "goal": Goal(text=text) if text else None,
        "begun_ns": 1,
        "created_ns": 1,
    }
    return Correction.model_validate({**head, **fields})


said.count = 0  # type: ignore[attr-defined]
