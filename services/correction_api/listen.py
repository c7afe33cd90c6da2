"""Listen: takes what robots and learner say off the bus, and writes it on the watch's board."""

from collections import deque
from collections.abc import Callable
from typing import TypeVar

import structlog

from services.correction_api.calls import Calls
from services.correction_api.metrics import Metrics
from services.correction_api.store.episodes import Episodes
from services.correction_api.store.writer import StoreError
from services.correction_api.watch import Watch
from shared.errors import MessageError
from shared.messages.decision import Decision
from shared.messages.episode import Episode
from shared.messages.heartbeat import LearnerHeartbeat, RobotHeartbeat
from shared.messages.help import Help
from shared.messages.message import Message
from shared.messages.policy import PolicyAnnouncement
from shared.wire.bus import Bus, Handler
from shared.wire.codec import decode
from shared.wire.keys import any_robot, any_service, parse

REMEMBERED_CALLS = 1024

M = TypeVar("M", bound=Message)
log = structlog.get_logger()


class Listener:
    """The subscriptions of the API, except those for pictures; close it to end them."""

    def __init__(
        self,
        bus: Bus,
        fleet: str,
        watch: Watch,
        calls: Calls,
        episodes: Episodes,
        metrics: Metrics,
    ) -> None:
        self._watch, self._calls = watch, calls
        self._episodes, self._metrics = episodes, metrics
        self._called: deque[str] = deque(maxlen=REMEMBERED_CALLS)
        take = self._taking
        self._subscriptions = [
            bus.subscribe(any_robot(fleet, "heartbeat"), take(RobotHeartbeat, self._beat)),
            bus.subscribe(any_robot(fleet, "decision"), take(Decision, self._decide)),
            bus.subscribe(any_robot(fleet, "episode"), take(Episode, self._end)),
            bus.subscribe(
                any_service(fleet, "learner", "heartbeat"), take(LearnerHeartbeat, watch.learner)
            ),
            bus.follow(
                any_service(fleet, "learner", "policy"), take(PolicyAnnouncement, watch.policy)
            ),
        ]

    def close(self) -> None:
        """Hear nothing more."""
        for subscription in self._subscriptions:
            subscription.close()

    def _beat(self, heartbeat: RobotHeartbeat) -> None:
        self._watch.robot(heartbeat)
        self._calls.tell(heartbeat.robot, heartbeat.help, heartbeat.time_ns)

    def _decide(self, decision: Decision) -> None:
        self._calls.tell(decision.robot, decision.help, decision.time_ns)
        if decision.help:
            self._keep(decision.episode, decision.help)
        self._watch.decision(decision)  # It rings for who waits, and reads the queue then.

    def _keep(self, episode: str, help: Help) -> None:
        """A call lasts over many decisions, and is written once."""
        if help.decision in self._called:
            return
        self._called.append(help.decision)
        try:
            self._episodes.call(episode, help)
        except StoreError as error:
            log.warning("a call for help is not in the history", reason=str(error))

    def _end(self, episode: Episode) -> None:
        self._calls.tell(episode.robot, None, episode.ended_ns)
        self._watch.episode(episode)
        try:
            self._episodes.add(episode)
        except StoreError as error:
            log.warning("an episode is not in the history", episode=episode.id, reason=str(error))

    def _taking(self, cls: type[M], write: Callable[[M], None]) -> Handler:
        def take(key: str, payload: bytes) -> None:
            try:
                write(_own(key, decode(cls, payload)))
            except MessageError as error:
                self._metrics.unreadable.inc()
                log.warning("a message was not understood", key=key, reason=str(error))

        return take


def _own(key: str, message: M) -> M:
    """The message, if it is about the one on whose key it came: nobody speaks for another."""
    speaker = getattr(message, "robot", None) or getattr(message, "learner", None)
    if speaker != parse(key).id:
        raise MessageError(f"it is about {speaker!r}")
    return message
