"""Judge: what a person of given attention says about a decision. Pure; the same for equal seeds."""

import json
import random
from dataclasses import replace
from enum import StrEnum
from typing import NamedTuple

from services.oracle.config import OracleSettings
from services.oracle.seen import Seen
from shared.workcell.skills import SKILLS, is_there
from shared.workcell.state import CellState
from shared.workcell.tasks import task_named


class Kind(StrEnum):
    """What a person can say of a decision; the API knows these words."""

    OVERRIDE = "override"
    RELEASE = "release"
    APPROVE = "approve"
    PASS = "pass"


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


def judge(seen: Seen, settings: OracleSettings) -> Verdict:
    """What the person says; `pass` when there is nothing to say.

    Raises:
        WorkcellError: the truth, the task or the prompt is none that the cell knows.
    """
    chance = _chance(seen, settings.seed)
    if chance.random() < settings.miss_rate:
        return Verdict(Kind.PASS, missed=True)
    right_now, right, there = _know(seen)
    verdict = _ideal(seen, right_now, right)
    if verdict.kind is Kind.OVERRIDE and chance.random() < settings.wrong_phrase_rate:
        slip = chance.choice([text for text in there if text not in right])
        return Verdict(Kind.OVERRIDE, slip, wrong=True)
    return verdict


def _ideal(seen: Seen, right_now: str, right: frozenset[str]) -> Verdict:
    """Without mistakes: interfere no more than is needed, and let go as soon as one can."""
    if seen.held and seen.top in right:
        return Verdict(Kind.RELEASE)
    if seen.executed.text in right:
        return Verdict(Kind.APPROVE)
    return Verdict(Kind.OVERRIDE, right_now)


def _know(seen: Seen) -> tuple[str, frozenset[str], list[str]]:
    """The right command now, all that are right, and all about what is there."""
    truth = dict(seen.truth)
    settled = truth.pop("brief", None)
    truth.pop("disturbed", None)
    state, task = CellState.from_json(truth), task_named(seen.task)
    brief = task.understand(seen.prompt)
    if settled:  # What a sentence like "all on the left" meant when the episode began.
        target = tuple(str(name) for name in settled["target"])
        brief = replace(brief, target=target, ordered=bool(settled["ordered"]))
    return (
        task.next_command(state, brief, seen.before),
        task.acceptable_commands(state, brief, seen.before),
        [skill.text for skill in SKILLS if is_there(skill, state)],
    )


def _chance(seen: Seen, seed: int) -> random.Random:
    """Chance that hangs on the scene and not on ids, so that a run can be repeated."""
    scene = json.dumps([seed, seen.robot, seen.index, seen.step, seen.prompt, seen.truth])
    return random.Random(scene)
