"""What a person of given attention says about a decision. Pure; the same for equal seeds.

The scripted person of the oracle, who speaks over HTTP, and that of the experiments, who doesn't.
"""

import json
import random
from collections.abc import Mapping, Sequence
from dataclasses import replace
from enum import StrEnum
from typing import Annotated, Any, NamedTuple, Protocol

from pydantic import Field

from shared.config import Settings
from shared.messages.policy import is_version
from shared.workcell.skills import SKILLS, is_there
from shared.workcell.state import CellState
from shared.workcell.tasks import task_named


class Kind(StrEnum):
    """What a person can say of a decision; the API knows these words."""

    OVERRIDE = "override"
    RELEASE = "release"
    APPROVE = "approve"
    PASS = "pass"


Share = Annotated[float, Field(ge=0, le=1)]


class Habits(Settings):
    """How well somebody attends.

    miss_rate: share of decisions that they don't look at: never approved, never corrected.
    wrong_phrase_rate: share of overrides in which they say a wrong command.
    seed: equal seeds miss and slip at equal scenes.
    """

    miss_rate: Share = 0.0
    wrong_phrase_rate: Share = 0.0
    seed: Annotated[int, Field(ge=0)] = 0


class Words(Protocol):
    """A goal in words."""

    @property
    def text(self) -> str: ...


class Proposed(Protocol):
    """What the high level considered."""

    @property
    def goal(self) -> Words: ...


class Seen(Protocol):
    """A decision as a person sees it, with the truth, which no person has; see `Decision`."""

    @property
    def robot(self) -> str: ...
    @property
    def index(self) -> int: ...
    @property
    def step(self) -> int: ...
    @property
    def task(self) -> str: ...
    @property
    def prompt(self) -> str: ...
    @property
    def previous(self) -> tuple[str, ...]: ...
    @property
    def proposed(self) -> Sequence[Proposed]: ...
    @property
    def executed(self) -> Words: ...
    @property
    def chosen_by(self) -> str: ...
    @property
    def truth(self) -> Mapping[str, Any]: ...


class Verdict(NamedTuple):
    """What to say: a kind of correction, and for an override the command.

    missed: it did not look. wrong: it means well and says a wrong command.
    """

    kind: Kind
    text: str | None = None
    missed: bool = False
    wrong: bool = False

    @property
    def objects(self) -> bool:
        """Something is to be done instead."""
        return self.kind in (Kind.OVERRIDE, Kind.RELEASE)


def judge(seen: Seen, habits: Habits) -> Verdict:
    """What the person says; `pass` when there is nothing to say.

    Raises:
        WorkcellError: the truth, the task or the prompt is none that the cell knows.
    """
    chance = _chance(seen, habits.seed)
    if chance.random() < habits.miss_rate:
        return Verdict(Kind.PASS, missed=True)
    right_now, right, there = _know(seen)
    verdict = _ideal(seen, right_now, right)
    if verdict.kind is Kind.OVERRIDE and chance.random() < habits.wrong_phrase_rate:
        slip = chance.choice([text for text in there if text not in right])
        return Verdict(Kind.OVERRIDE, slip, wrong=True)
    return verdict


def held(seen: Seen) -> bool:
    """Somebody's override was holding."""
    return not is_version(seen.chosen_by)


def top(seen: Seen) -> str:
    """What the policy itself would do now."""
    return seen.proposed[0].goal.text


def _ideal(seen: Seen, right_now: str, right: frozenset[str]) -> Verdict:
    """Without mistakes: interfere no more than is needed, and let go as soon as one can."""
    if held(seen) and top(seen) in right:
        return Verdict(Kind.RELEASE)
    if seen.executed.text in right:
        return Verdict(Kind.APPROVE)
    return Verdict(Kind.OVERRIDE, right_now)


def _know(seen: Seen) -> tuple[str, frozenset[str], list[str]]:
    """The right command now, all that are right, and all about what is there."""
    truth = dict(seen.truth)
    settled = truth.pop("brief", None)
    truth.pop("disturbed", None)
    before = seen.previous[-1] if seen.previous else None
    state, task = CellState.from_json(truth), task_named(seen.task)
    brief = task.understand(seen.prompt)
    if settled:  # What a sentence like "all on the left" meant when the episode began.
        target = tuple(str(name) for name in settled["target"])
        brief = replace(brief, target=target, ordered=bool(settled["ordered"]))
    return (
        task.next_command(state, brief, before),
        task.acceptable_commands(state, brief, before),
        [skill.text for skill in SKILLS if is_there(skill, state)],
    )


def _chance(seen: Seen, seed: int) -> random.Random:
    """Chance that hangs on the scene and not on ids, so that a run can be repeated."""
    scene = json.dumps([seed, seen.robot, seen.index, seen.step, seen.prompt, dict(seen.truth)])
    return random.Random(scene)
