"""One episode of an evaluation: a hierarchy in lockstep, without corrections, watched."""

from collections.abc import Callable, Sequence
from typing import NamedTuple, Protocol

import numpy as np
import torch
from numpy.typing import NDArray

from shared.clock import SystemClock
from shared.evaluation.attempts import Row, skill_of
from shared.evaluation.plan import ORACLE, Case, Plan
from shared.evaluation.watch import Watch
from shared.messages.decision import Proposal
from shared.messages.goal import Goal
from shared.messages.observation import Observation
from shared.messages.policy import Version
from shared.policies.high_level import HighLevel
from shared.policies.low_level import LowLevel
from shared.rollout import robot as seams
from shared.rollout.rollout import Rollout
from shared.rollout.thinking import Lockstep
from shared.workcell.env import objects
from shared.workcell.skills import Skill
from shared.workcell.station import Station


class Oracle:
    """The high level that knows: it reads the true state and is never wrong."""

    version = Version(0, 0)

    def __init__(self, station: Station) -> None:
        self._station = station

    def propose(
        self, observation: Observation, past: Sequence[NDArray[np.uint8]] = ()
    ) -> tuple[Proposal, ...]:
        del past  # Unused: what is true now is all that it needs.
        previous = observation.previous[-1] if observation.previous else None
        goal = Goal(text=self._station.right_command(previous))
        return (Proposal(goal=goal, score=1.0),)


class Obedient(seams.LowLevel, Protocol):
    """A low level that says which command it takes a goal for; None: for none that is known."""

    def meaning(self, goal: Goal, objects: NDArray[np.float32]) -> str | None: ...


class Levels(NamedTuple):
    """Who acts. worded: what the high level says are commands, which can be right or wrong."""

    high: seams.HighLevel
    low: Obedient
    worded: bool = True


def levels_of(plan: Plan, station: Station) -> Levels:
    """Those that the plan names."""
    high = (
        Oracle(station)
        if plan.high_level == ORACLE
        else HighLevel.load(plan.high_level_folder(), plan.rollout.head)
    )
    return Levels(high, LowLevel.load(plan.low_level_folder()))


class Evaluator:
    """One process's policies and cell, ready for one case of `plan` after another."""

    def __init__(self, plan: Plan, levels: Callable[[Plan, Station], Levels] = levels_of) -> None:
        """levels: where policies of another kind come from."""
        torch.set_num_threads(1)  # The processes share the cores.
        self.plan = plan
        self._station = Station(plan.site, plan.skills)
        self._high_level, self._low_level, self._worded = levels(plan, self._station)

    def __call__(self, case: Case) -> Row:
        """Roll out one episode."""
        scene = self._station.reset(case.seed, case.task, None)
        watch, diverged = Watch(self._station.env, self._meant), self._station.env.cell.diverged
        rollout = Rollout(
            self._station,
            self._high_level,
            self._low_level,
            Lockstep(self.plan.rollout.latency_steps),
            SystemClock(),
            self.plan.rollout,
            name="evaluation",
            episode=f"seed-{case.seed}",
            scene=scene,
            decided=(lambda decision: watch.decided(decision.executed.text))
            if self._worded
            else None,
        )
        while not rollout.over:
            if rollout.advance() and rollout.command and self._worded:
                watch.stepped(rollout.command.text, rollout.step)
        attempts = watch.finish(rollout.step, rollout.done)
        return Row(
            seed=case.seed,
            task=case.task,
            prompt=scene.prompt,
            success=rollout.done,
            progress=round(self._station.progress, 4),
            steps=rollout.step,
            decisions=rollout.decisions,
            asked={str(why): count for why, count in rollout.asked.items()},
            wrong=watch.wrong,
            failure=watch.failure,
            failed_step=watch.failed_step,
            diverged=self._station.env.cell.diverged - diverged,
            attempts=attempts,
            low_level_sha256=self._low_level.fingerprint(),
        )

    def _meant(self, text: str) -> Skill | None:
        """The skill that the low level takes a command for, in the scene as it is."""
        command = self._low_level.meaning(Goal(text=text), objects(self._station.env.state))
        return skill_of(command) if command else None

    def close(self) -> None:
        """Give the cell back."""
        self._station.close()
