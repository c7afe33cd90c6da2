"""Evaluate: how often a high level succeeds on seeds that no correction ever came from.

Rolls out in lockstep without corrections, on all cores; what was done is kept in a file of rows
beside the report, so that a run that was stopped goes on where it was.
"""

import json
import multiprocessing
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray

from services.actor.build import make_robot
from shared.clock import SystemClock
from shared.intervals import wilson
from shared.messages.decision import Proposal
from shared.messages.goal import Goal
from shared.messages.observation import Observation
from shared.messages.policy import Version
from shared.policies.checkpoint import bundled
from shared.policies.high_level import HighLevel
from shared.policies.low_level import LowLevel
from shared.rollout import robot as seams
from shared.rollout.rollout import Rollout
from shared.rollout.settings import RolloutSettings
from shared.rollout.thinking import Lockstep
from shared.seeds import EVALUATION
from shared.workcell.site import load_site
from shared.workcell.station import Station
from shared.workcell.tasks import task_named

ORACLE, BASE = "oracle", "base"


class Plan(NamedTuple):
    """What to evaluate. high_level: "base", "oracle" or a checkpoint folder."""

    high_level: str
    tasks: tuple[str, ...]
    site: str
    episodes: int
    rollout: RolloutSettings = RolloutSettings()
    low_level: str = ""
    first_seed: int = EVALUATION.start


class Row(NamedTuple):
    """One episode of an evaluation."""

    seed: int
    task: str
    prompt: str
    success: bool
    steps: int
    decisions: int
    low_level_sha256: str


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


def episodes(plan: Plan) -> list[tuple[int, str]]:
    """The (seed, task) pairs of a plan: the same ones for every high level, so they are paired."""
    return [(plan.first_seed + i, plan.tasks[i % len(plan.tasks)]) for i in range(plan.episodes)]


def check(plan: Plan) -> None:
    """Find what can't work before any process is started.

    Raises:
        HldError: an unknown site or task, a checkpoint that can't be used; says what is known.
    """
    load_site(plan.site)
    for task in plan.tasks:
        task_named(task)
    LowLevel.load(low_level_folder(plan))
    if plan.high_level not in (ORACLE, BASE):
        HighLevel.load(Path(plan.high_level))


class Evaluator:
    """One process's policies and robot, ready to roll out one seed after another."""

    def __init__(self, plan: Plan) -> None:
        torch.set_num_threads(1)
        self._plan = plan
        robot = make_robot("workcell", plan.site)
        assert isinstance(robot, Station)
        self._robot = robot
        self._low_level = LowLevel.load(low_level_folder(plan))
        self._high_level = self._make_high_level()

    def _make_high_level(self) -> seams.HighLevel:
        if self._plan.high_level == ORACLE:
            return Oracle(self._robot)
        base = self._plan.high_level == BASE
        folder = bundled("high_level") if base else Path(self._plan.high_level)
        return HighLevel.load(folder, self._plan.rollout.head)

    def roll_out(self, seed: int, task: str) -> Row:
        """One episode without corrections."""
        scene = self._robot.reset(seed, task, None)
        rollout = Rollout(
            self._robot,
            self._high_level,
            self._low_level,
            Lockstep(self._plan.rollout.latency_steps),
            SystemClock(),
            self._plan.rollout,
            name="evaluation",
            episode=f"seed-{seed}",
            scene=scene,
        )
        while not rollout.over:
            rollout.advance()
        return Row(
            seed,
            task,
            scene.prompt,
            rollout.done,
            rollout.step,
            rollout.decisions,
            self._low_level.fingerprint(),
        )


def low_level_folder(plan: Plan) -> Path:
    """Where the low level of a plan lies."""
    return Path(plan.low_level) if plan.low_level else bundled("low_level")


_evaluator: Evaluator | None = None  # One a worker process, made by its initializer.


def _start(plan: Plan) -> None:
    global _evaluator
    _evaluator = Evaluator(plan)


def _roll_out(pair: tuple[int, str]) -> Row:
    assert _evaluator is not None
    return _evaluator.roll_out(*pair)


def evaluate(plan: Plan, processes: int, done: Sequence[Row] = ()) -> Iterator[Row]:
    """Rows as they are finished, in order; those in `done` come first and aren't rolled out."""
    finished = {(row.seed, row.task): row for row in done}
    yield from finished.values()
    missing = [pair for pair in episodes(plan) if pair not in finished]
    if not missing:
        return
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(
        min(processes, len(missing)), mp_context=context, initializer=_start, initargs=(plan,)
    ) as pool:
        yield from pool.map(_roll_out, missing)


def read_rows(file: Path) -> list[Row]:
    """The rows of a run that was stopped; a half-written last line is dropped."""
    rows = []
    for line in file.read_text().splitlines() if file.exists() else ():
        try:
            rows.append(Row(**json.loads(line)))
        except (json.JSONDecodeError, TypeError):
            break
    return rows


def summarize(rows: Iterable[Row]) -> dict[str, Any]:
    """Success with n and a 95 % interval, over all and by task."""
    rows = list(rows)
    tasks = sorted({row.task for row in rows})
    return {
        **_rate(rows),
        "low_level_sha256": sorted({row.low_level_sha256 for row in rows}),
        "tasks": {task: _rate([row for row in rows if row.task == task]) for task in tasks},
        "steps": round(sum(row.steps for row in rows) / max(1, len(rows)), 1),
        "decisions": round(sum(row.decisions for row in rows) / max(1, len(rows)), 1),
    }


def _rate(rows: Sequence[Row]) -> dict[str, Any]:
    successes = sum(row.success for row in rows)
    low, high = wilson(successes, len(rows))
    return {
        "success": round(successes / max(1, len(rows)), 4),
        "n": len(rows),
        "interval": [round(low, 4), round(high, 4)],
    }
