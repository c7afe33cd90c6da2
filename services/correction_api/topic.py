"""Topic: which episode a correction is about, and whether anything can be said about it still.

Ids of decisions are `<episode>-<index>`, as `shared/rollout` makes them, so that one which this
service never heard of, or has forgotten, tells its episode still.
"""

import asyncio
from typing import NamedTuple

from services.correction_api.problems import Problem, shorten
from services.correction_api.store.episodes import Episodes
from services.correction_api.utterance import Utterance
from services.correction_api.watch import Sight, Watch
from shared.messages.correction import Kind
from shared.messages.decision import Decision


class Address(NamedTuple):
    """Where a decision belongs: the how-manieth of which episode."""

    episode: str
    number: int


class Topics:
    """Holds what was said against what is known of the robot."""

    def __init__(self, watch: Watch, episodes: Episodes) -> None:
        self._watch, self._episodes = watch, episodes

    async def find(self, robot: str, said: Utterance, sight: Sight) -> tuple[str, int | None]:
        """The episode that it is about, and the step of the decision that it names.

        Raises:
            Problem: no such decision, an episode that is over or that nobody heard of, or none.
        """
        if said.kind is Kind.PAUSE and (latest := self._watch.latest_episode(robot)):
            return latest, None  # It counts in any episode; the log wants one.
        decision = self._watch.decided(robot, said.decision) if said.decision else None
        address = _locate(said.decision, decision, sight) if said.decision else None
        _check_agreement(said, address)
        episode = said.episode or (address.episode if address else sight.episode)
        if episode is None:
            detail = f"{robot} is between two episodes; wait until the next one has begun"
            raise _conflict("no-episode", "No episode is running", detail, sight)
        await self._check_running(robot, episode)
        if address and decision is None:
            self._check_made(robot, address)
        return episode, decision.step if decision else None

    async def _check_running(self, robot: str, episode: str) -> None:
        """Refuse an episode that is over, and one that nobody heard of."""
        over = self._watch.ended(robot, episode)
        over = over or await asyncio.to_thread(self._episodes.ended, episode)
        sight = self._watch.look(robot)
        # A decision may tell of a new episode sooner than a heartbeat; the robot knows best then.
        if not over and episode in (sight.episode, sight.decision and sight.decision.episode):
            return
        now = f"the current one is {sight.episode}" if sight.episode else "no other has begun"
        if over or self._watch.last_of(robot, episode):
            detail = f"episode {episode} of {robot} is over; {now}"
            raise _conflict("episode-over", "The episode is over", detail, sight)
        detail = f"episode {episode} of {robot} is unknown, or over for long; {now}"
        raise _conflict("unknown-episode", "No episode has this id", detail, sight)

    def _check_made(self, robot: str, address: Address) -> None:
        """Refuse a decision that is still to come; if none was heard of, the robot judges."""
        newest = self._watch.last_of(robot, address.episode)
        if newest and address.number > newest.index:
            raise _unknown(f"{address.episode}-{address.number}", self._watch.look(robot))


def current(sight: Sight) -> dict[str, str | int | None]:
    """What a robot is about now, for an answer that says no."""
    return {
        "episode": sight.episode,
        "step": sight.heartbeat.step,
        "command": sight.force.text if sight.force else None,
        "decision": sight.decision.id if sight.decision else None,
    }


def _locate(name: str, decision: Decision | None, sight: Sight) -> Address:
    if decision:
        return Address(decision.episode, decision.index)
    episode, _, index = name.rpartition("-")
    if not episode or not index.isdigit() or str(int(index)) != index:
        raise _unknown(name, sight)
    return Address(episode, int(index))


def _check_agreement(said: Utterance, address: Address | None) -> None:
    if address and said.episode not in (None, address.episode):
        detail = (
            f"decision {said.decision} is of episode {address.episode}, not of {said.episode}; "
            "leave episode out, or give that of the decision"
        )
        raise Problem(422, "invalid", "The request is not valid", detail)


def _unknown(name: str, sight: Sight) -> Problem:
    newest = f"the newest is {sight.decision.id}" if sight.decision else "none was heard of yet"
    detail = f"no decision {shorten(name)} of {sight.heartbeat.robot}; {newest}"
    title = "No decision has this id"
    return Problem(404, "unknown-decision", title, detail, current=current(sight))


def _conflict(name: str, title: str, detail: str, sight: Sight) -> Problem:
    return Problem(409, name, title, detail, current=current(sight))
