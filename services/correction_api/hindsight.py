"""Hindsight: which episode is meant by what is said afterwards, and whether it is still running.

Beside `topic.py`, which does it for what is said now: of the past one may speak when the episode is
over, its robot is away, and this service was started anew; what is needed stands on the disk.
"""

import asyncio
from collections.abc import Callable
from typing import NamedTuple

from services.correction_api.problems import Problem, shorten
from services.correction_api.store.episodes import Episodes
from services.correction_api.store.log import Entry, Log
from services.correction_api.utterance import Utterance
from services.correction_api.watch import Sight, Watch
from shared.errors import nearest
from shared.messages.correction import TARGETS, Kind

LAG_STEPS = 50
"""By so much a running episode may be ahead of what was heard of it: a second, at 50 Hz."""
SHOWN = 200

_HINTS = {
    Kind.RETRACT: "what was taken back can't be brought back: say it again",
    Kind.EDIT: "edit the correction that it was about once more: the last edit counts",
    Kind.RETIME: "retime the correction that it was about once more: the last one counts",
}


class Place(NamedTuple):
    """What a correction is about.

    seen_step: of the decision that it names. over: no robot has to hear it.
    """

    episode: str
    seen_step: int | None
    over: bool


class _Known(NamedTuple):
    """What is known of an episode: how many steps and decisions it has, and whether it ended.

    None: nobody told yet.
    """

    steps: int | None
    decisions: int | None
    over: bool


class Hindsight:
    """Holds what was said of the past against what is known of it."""

    def __init__(
        self, watch: Watch, episodes: Episodes, kept: Log, find: Callable[[str], Sight]
    ) -> None:
        """find: raises the problem that a robot was never heard of."""
        self._watch, self._episodes, self._log, self._find = watch, episodes, kept, find

    async def find(self, robot: str, said: Utterance) -> Place:
        """The episode that it is about.

        Raises:
            Problem: no such target, episode, decision or robot, or steps beyond what is known.
        """
        return await asyncio.to_thread(self._look, robot, said)

    def _look(self, robot: str, said: Utterance) -> Place:
        if said.target is not None:
            episode = self._target(robot, said, said.target).correction.episode
        else:
            episode = said.episode or _episode_of(said)
        known = self._known(robot, episode, sure=said.target is not None)
        _check_steps(said, episode, known)
        if said.decision is not None:
            _check_decision(said.decision, episode, known)
        heard_of = said.decision is not None and robot in self._watch.names()
        seen = self._watch.decided(robot, said.decision or "") if heard_of else None
        return Place(episode, seen.step if seen else None, known.over)

    def _target(self, robot: str, said: Utterance, name: str) -> Entry:
        entry = find_correction(self._log, name)
        target = entry.correction
        if target.robot != robot:
            raise _invalid(f"{name} is about {target.robot}, not about {robot}; say this of it")
        if said.episode not in (None, target.episode):
            detail = (
                f"{name} is about episode {target.episode}, not {said.episode}; "
                "leave episode out, or give that of the target"
            )
            raise _invalid(detail)
        if target.kind not in TARGETS[said.kind]:
            fits = ", ".join(kind for kind in Kind if kind in TARGETS[said.kind])
            hint = _HINTS.get(target.kind, f"{said.kind} is for {fits}")
            raise _invalid(f"{name} is a {target.kind}, of which there is no {said.kind}; {hint}")
        return entry

    def _known(self, robot: str, episode: str, *, sure: bool) -> _Known:
        """sure: there was such an episode, since something was said about it."""
        told = self._episodes.find(episode)
        if told is not None and told.robot == robot:
            return _Known(told.steps, told.decisions, over=True)
        if sure and told is None and robot not in self._watch.names():
            return _Known(None, None, over=False)  # It may be at work still: it will be asked.
        sight, last = self._find(robot), self._watch.last_of(robot, episode)
        heard = sight.heartbeat.step if sight.heartbeat.episode == episode else 0
        steps = max(heard, last.step + 1 if last else 0) or None
        newest = sight.decision.episode if sight.decision else None
        over = self._watch.ended(robot, episode) or episode not in (sight.episode, newest)
        if over and not (sure or last or self._watch.ended(robot, episode)):
            now = f"the current one is {sight.episode}" if sight.episode else "none is running"
            detail = f"no episode {shorten(episode)} of {robot} is known; {now}"
            raise Problem(409, "unknown-episode", "No episode has this id", detail)
        return _Known(None if over or steps is None else steps + LAG_STEPS, None, over)


def find_correction(kept: Log, name: str) -> Entry:
    """The entry of a correction.

    Raises:
        Problem: there is none; the nearest of the last ones are named.
    """
    entry = kept.find(name)
    if entry is None:
        last = [entry.correction.id for entry in kept.page(None, None, SHOWN, None)]
        detail = f"no correction {shorten(name)}{nearest(name[:64], last)}"
        raise Problem(404, "unknown-correction", "No correction has this id", detail)
    return entry


def _episode_of(said: Utterance) -> str:
    """The episode that the id of a decision begins with, see `topic.py`."""
    episode, _, index = (said.decision or "").rpartition("-")
    if not episode or not index.isdecimal():
        raise _unknown(said.decision or "", "ids of decisions are EPISODE-NUMBER")
    return episode


def _check_steps(said: Utterance, episode: str, known: _Known) -> None:
    if said.end_step is not None and known.steps is not None and said.end_step > known.steps:
        detail = (
            f"end_step: {said.end_step} lies beyond what is known of {episode}; "
            f"at most {known.steps}"
        )
        raise _invalid(detail)


def _check_decision(decision: str, episode: str, known: _Known) -> None:
    name, _, index = decision.rpartition("-")
    if name != episode or not index.isdecimal():
        raise _invalid(f"decision {shorten(decision)} is not of episode {episode}; leave one out")
    if known.decisions is not None and int(index) >= known.decisions:
        last = (
            f"the last one is {episode}-{known.decisions - 1}"
            if known.decisions
            else "there was none"
        )
        raise _unknown(decision, last)


def _invalid(detail: str) -> Problem:
    return Problem(422, "invalid", "The request is not valid", detail)


def _unknown(decision: str, known: str) -> Problem:
    detail = f"no decision {shorten(decision)}; {known}"
    return Problem(404, "unknown-decision", "No decision has this id", detail)
