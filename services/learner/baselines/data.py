"""The demonstrations that every arm learns from: looks, and the steps that the expert made then.

An episode is seen in two ways at once: at decisions, as the high level is asked, with the right
command; and at each control step, with the action that the expert wants. One more look at a random
moment within each decision is for the arm that has no decisions.
"""

import hashlib
import shutil
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from safetensors.numpy import load_file, save_file

from services.learner.baselines.scale import Arm
from services.learner.pretrain import demonstrate, practice
from services.learner.pretrain.demonstrate import Demonstrations, Lesson, Record, episode
from services.learner.pretrain.practice import DECISION_STEPS, EXECUTE_STEPS, Steps
from shared.workcell import skills
from shared.workcell.env import WorkcellEnv, objects, proprioception
from shared.workcell.site import Site
from shared.workcell.skills import COMMANDS
from shared.workcell.state import CellState

Windows = NDArray[np.int64]
SILENT = COMMANDS[0]
"""Stands where a label would, for arms that get none."""


@dataclass(frozen=True, eq=False)
class Looks:
    """L looks, and of each the steps that an answer to it is for.

    windows: [L, 2], from the first step up to the last; empty where something else was done than
    would have been right, which nobody is to learn.
    """

    seen: Demonstrations
    windows: Windows

    def __len__(self) -> int:
        return len(self.seen)


@dataclass(frozen=True, eq=False)
class Teaching:
    """decisions, moments: looks at decisions, and one at random in each. steps: all that the expert
    did under the right command; a run lasts as long as nothing is left out."""

    decisions: Looks
    moments: Looks
    steps: Steps

    def save(self, folder: Path) -> None:
        """Write as a folder of safetensors, whole or not at all."""
        beside = folder.with_name(f"unfinished-{folder.name}")
        shutil.rmtree(beside, ignore_errors=True)
        beside.mkdir(parents=True)
        for name, looks in (("decisions", self.decisions), ("moments", self.moments)):
            looks.seen.save(beside / f"{name}.safetensors")
        self.steps.save(beside / "steps.safetensors")
        windows = {"decisions": self.decisions.windows, "moments": self.moments.windows}
        save_file(windows, beside / "windows.safetensors")
        beside.rename(folder)

    @classmethod
    def load(cls, folder: Path) -> "Teaching":
        """Read back."""
        windows = load_file(folder / "windows.safetensors")
        looks = {
            name: Looks(Demonstrations.load(folder / f"{name}.safetensors"), windows[name])
            for name in ("decisions", "moments")
        }
        steps = Steps.load(folder / "steps.safetensors")
        return cls(looks["decisions"], looks["moments"], steps)

    def sha256(self) -> str:
        """Hash over all of it."""
        digest = hashlib.sha256()
        for looks in (self.decisions, self.moments):
            shown = looks.seen.examples
            for text in (*shown.prompts, *shown.labels, *map("\t".join, shown.previous)):
                digest.update(f"{text}\n".encode())
            truth = looks.seen.status, looks.seen.positions, looks.seen.episodes
            for array in (shown.images, shown.senses, shown.looks, *truth, looks.windows):
                digest.update(np.ascontiguousarray(array).data)
        for field in fields(self.steps):
            digest.update(np.ascontiguousarray(getattr(self.steps, field.name)).data)
        return digest.hexdigest()


def join(parts: Sequence[Teaching]) -> Teaching:
    """All parts one after another."""
    first = np.cumsum([0, *(len(part.steps) for part in parts)])
    decisions = [_later(part.decisions, by) for part, by in zip(parts, first[:-1], strict=True)]
    moments = [_later(part.moments, by) for part, by in zip(parts, first[:-1], strict=True)]
    steps = practice.join([part.steps for part in parts])
    return Teaching(_joined(decisions), _joined(moments), steps)


def _later(looks: Looks, by: int) -> Looks:
    return replace(looks, windows=looks.windows + by)


def _joined(parts: Sequence[Looks]) -> Looks:
    seen = demonstrate.join([part.seen for part in parts])
    return Looks(seen, np.concatenate([part.windows for part in parts]))


def lessons_of(teaching: Teaching, arm: Arm) -> tuple[Looks, Steps]:
    """What one arm learns of it.

    Goals with words get labels, and a chunk ends where the command does. The others get neither
    labels (guided does), nor what was said before, nor whether it was achieved; their chunks go on.
    """
    if arm in ("hierarchy", "chain"):
        return teaching.decisions, _by_command(teaching.steps)
    looks = _flat(teaching) if arm == "flat" else teaching.decisions
    seen = _unheard(looks.seen)
    if arm != "guided":
        seen = replace(seen, examples=replace(seen.examples, labels=[SILENT] * len(seen)))
    return replace(looks, seen=seen), _silent(teaching.steps)


def _flat(teaching: Teaching) -> Looks:
    """Every look by itself, for as long as a chunk is executed."""
    every = _joined([teaching.decisions, teaching.moments])
    shown = every.seen.examples
    looks = shown.looks.copy()
    looks[:, :-1] = -1
    windows = every.windows.copy()
    windows[:, 1] = np.minimum(windows[:, 1], windows[:, 0] + EXECUTE_STEPS)
    return Looks(replace(every.seen, examples=replace(shown, looks=looks)), windows)


def _unheard(seen: Demonstrations) -> Demonstrations:
    """As an arm meets them that says no words."""
    return replace(seen, examples=replace(seen.examples, previous=[()] * len(seen)))


def _silent(steps: Steps) -> Steps:
    return replace(steps, commands=np.zeros_like(steps.commands), done=np.zeros_like(steps.done))


def _by_command(steps: Steps) -> Steps:
    """A run ends where another command begins, too."""
    change = (np.diff(steps.commands) != 0) | (np.diff(steps.runs) != 0)
    runs = np.concatenate([[0], np.cumsum(change)]).astype(np.int32)
    return replace(steps, runs=runs)


class _Scribe:
    """Writes down what the expert does, while the episode is driven."""

    def __init__(self, env: WorkcellEnv, record: Record) -> None:
        self._env, self._record, self._moments = env, record, Record()
        self._seen: list[NDArray[np.float32]] = []
        self._things: list[NDArray[np.float32]] = []
        self._wanted: list[NDArray[np.float64]] = []
        self._commands: list[int] = []
        self._done: list[bool] = []
        self._runs: list[int] = []
        self.decided: list[list[int]] = []
        self.looked: list[list[int]] = []
        self._run, self._said = 0, ""
        self._before: CellState | None = None
        self._seed, self._rng = 0, np.random.default_rng()
        self._look_at = -1

    def begin(self, seed: int) -> None:
        self._seed, self._rng = seed, np.random.default_rng([seed, 2])
        self._said, self._run = "", self._run + 1

    def wrote(self, command: str, wanted: NDArray[np.float64]) -> None:
        """See `demonstrate.episode`, `expected`."""
        now = self._env.elapsed_steps
        if command != self._said:
            self._said, self._before = command, self._env.state
        if len(self.decided) < len(self._record.labels):
            self.decided.append([len(self._runs)] * 2)
            self._look_at = now + int(self._rng.integers(1, DECISION_STEPS))
        if command != self._record.labels[-1]:
            self._run += 1
            return
        if now == self._look_at:
            self._moments.begin()
            self._moments.add(self._env, self._seed, (), command)
            self.looked.append([len(self._runs)] * 2)
        self._write(command, wanted)
        self.decided[-1][1] += 1
        if now >= self._look_at:
            self.looked[-1][1] += 1

    def _write(self, command: str, wanted: NDArray[np.float64]) -> None:
        state, before = self._env.state, self._before
        assert before is not None  # Set with the command.
        self._seen.append(proprioception(state))
        self._things.append(objects(state))
        self._wanted.append(wanted)
        self._commands.append(COMMANDS.index(command))
        self._done.append(skills.achieved(skills.parse(command), before, state))
        self._runs.append(self._run)

    def done(self) -> Teaching:
        steps = Steps(
            np.stack(self._seen),
            np.stack(self._things),
            np.stack(self._wanted).astype(np.float32),
            np.array(self._commands, np.int16),
            np.array(self._done, np.bool_),
            np.array(self._runs, np.int32),
        )
        decisions = Looks(self._record.done(), np.array(self.decided, np.int64))
        return Teaching(decisions, Looks(self._moments.done(), np.array(self.looked)), steps)


def teach(seeds: Sequence[int], mistakes: float, slips: float) -> Teaching:
    """Episodes in the lab by the expert's hand. mistakes, slips: as in `Lesson`."""
    env = WorkcellEnv(Site(name="lab", slip_rate=slips))
    lesson, record = Lesson(tuple(seeds), mistakes=mistakes, slips=slips), Record()
    scribe = _Scribe(env, record)
    for seed in seeds:
        scribe.begin(seed)
        episode(env, seed, lesson, record, expected=scribe.wrote)
    env.close()
    return scribe.done()
