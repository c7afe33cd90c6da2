"""Accept: the path of a correction from a person's words to the robot's receipt.

Said, checked, committed to disk (with its parcel to the learner), acknowledged; then the
messenger asks the robot, and the receipt closes it. Nothing is acknowledged before the commit.
What is said about an episode that is over is closed by the commit.
"""

import asyncio
from collections.abc import Callable

from services.correction_api.deliver import Messenger
from services.correction_api.hindsight import Hindsight, Place
from services.correction_api.metrics import Metrics
from services.correction_api.problems import Problem, shorten, unavailable
from services.correction_api.store.episodes import Episodes
from services.correction_api.store.log import Closed, Entry, Log, Status
from services.correction_api.topic import Topics
from services.correction_api.utterance import Utterance
from services.correction_api.views import Presence
from services.correction_api.watch import Sight, Watch
from shared.clock import Clock
from shared.errors import nearest
from shared.messages.correction import AFTERWARDS, Correction
from shared.messages.message import new_id
from shared.messages.phrase import PhraseAnswer

MAX_ID = 64
Understood = Callable[[str, str], PhraseAnswer | None]


class Desk:
    """Where words are handed in."""

    def __init__(
        self,
        watch: Watch,
        kept: Log,
        episodes: Episodes,
        clock: Clock,
        metrics: Metrics,
        answer_s: float,
        settle_s: float,
        understood: Understood,
    ) -> None:
        """understood: what the low level of a robot makes of a phrase; None: none can be asked."""
        self._watch, self._log, self._clock = watch, kept, clock
        self._understood = understood
        self._topics = Topics(watch, episodes)
        self._hindsight = Hindsight(watch, episodes, kept, self.find)
        self._metrics, self._answer_s = metrics, answer_s
        self._settled_ns = clock.monotonic_ns() + int(settle_s * 1e9)
        self._waiting: dict[str, asyncio.Future[Entry]] = {}
        self._messenger: Messenger | None = None
        self._spoken: Callable[[Entry], None] = _unheard

    def start(self, messenger: Messenger, spoken: Callable[[Entry], None]) -> None:
        """Take up what has no receipt yet from before a restart.

        spoken: told of every correction that is kept or closed, on the event loop.
        """
        self._messenger, self._spoken = messenger, spoken
        pending = self._log.pending()
        for entry in pending:
            self._waiting[entry.correction.id] = asyncio.get_running_loop().create_future()
        messenger.send(pending)

    async def accept(self, robot: str, said: Utterance, name: str | None) -> Entry:
        """Keep what was said and see what becomes of it, for `answer_s` at the longest.

        name: the client's own id, which makes it safe to send the same again.

        Raises:
            Problem: unknown robot or decision, an episode that is over, an id used otherwise, or
                words about the past that the low level doesn't understand.
            StoreError: it could not be kept.
        """
        digest = said.digest(robot)
        if name and (entry := await asyncio.to_thread(self._log.find, name)):
            return await self._outcome(_same(entry, digest), self._answer_s)
        place = await self._locate(robot, said)
        doubt = await self._read(robot, said)
        now_ns = self._clock.now_ns()
        correction = said.formulate(
            name or new_id("say"), robot, place.episode, place.seen_step, now_ns
        )
        status = Status.KEPT if place.over else Status.PENDING
        entry = await self._keep(correction, digest, status, doubt)
        return await self._outcome(_same(entry, digest), self._patience_s(robot))

    @property
    def settled(self) -> bool:
        """A robot that has not spoken by now is none."""
        return self._clock.monotonic_ns() >= self._settled_ns

    def find(self, robot: str) -> Sight:
        """What is known of a robot now.

        Raises:
            Problem: no robot has this id, or none has spoken yet since this service started.
        """
        try:
            return self._watch.look(robot)
        except KeyError:
            pass
        names = self._watch.names()
        if not self.settled:
            detail = f"robot {shorten(robot)} has not spoken yet since this service started"
            raise unavailable("starting", "Not heard of yet", detail)
        hint = nearest(robot[:MAX_ID], names) or "; no robot has been heard of yet"
        raise Problem(
            404, "unknown-robot", "No robot has this id", f"no robot {shorten(robot)}{hint}"
        )

    def close(self, closed: Closed) -> None:
        """A receipt came, or the time ran out: tell those who wait, and whom it concerns."""
        entry = closed.entry
        self._metrics.closed.labels(entry.status).inc()
        if entry.receipt:
            waited_ns = self._clock.now_ns() - entry.correction.created_ns
            self._metrics.latency.observe(waited_ns / 1e9)
            self._watch.obeyed(entry.correction, entry.receipt)
        waiting = self._waiting.pop(entry.correction.id, None)
        if waiting and not waiting.done():
            waiting.set_result(entry)
        self._spoken(entry)
        if closed.replaced:
            self._spoken(closed.replaced)

    async def _locate(self, robot: str, said: Utterance) -> Place:
        if said.kind in AFTERWARDS:
            return await self._hindsight.find(robot, said)
        return Place(*await self._topics.find(robot, said, self.find(robot)), over=False)

    async def _read(self, robot: str, said: Utterance) -> str:
        """Why it isn't known whether words about the past are understood; "" where they are.

        What is said now the robot itself refuses, by its receipt.
        """
        if said.text is None or said.kind not in AFTERWARDS:
            return ""
        answer = await asyncio.to_thread(self._understood, robot, said.text)
        if answer is None:
            return "no robot could be asked whether its low level understands this"
        if answer.means is None:
            nearest = [near.command for near in answer.nearest]
            title = "No robot could obey this"
            raise Problem(422, "not-understood", title, answer.refused, nearest=nearest)
        return ""

    def _patience_s(self, robot: str) -> float:
        """How long to wait for a receipt: not at all for one from a robot that is away."""
        if robot not in self._watch.names():
            return 0.0
        presence, _ = self._watch.presence(self._watch.look(robot).heard_ns)
        return 0.0 if presence is Presence.OFFLINE else self._answer_s

    async def _keep(self, correction: Correction, digest: str, status: Status, doubt: str) -> Entry:
        """Commit, then send what a robot has to hear; the first one of an id stays."""
        name = correction.id
        self._waiting.setdefault(name, asyncio.get_running_loop().create_future())
        try:
            entry = await asyncio.wrap_future(self._log.append(correction, digest, status, doubt))
        except BaseException:
            self._waiting.pop(name, None)
            raise
        if entry.status is not Status.PENDING:
            self._waiting.pop(name, None)
        if entry.correction is correction:
            assert self._messenger is not None  # `start` is called before anybody is let in.
            self._metrics.corrections.labels(correction.kind).inc()
            self._spoken(entry)
            if entry.status is Status.PENDING:
                self._messenger.send([entry])
            else:
                self._metrics.closed.labels(entry.status).inc()
        return entry

    async def _outcome(self, entry: Entry, timeout_s: float) -> Entry:
        """The entry once it is closed, or as it is when the time is out."""
        if entry.status is not Status.PENDING:
            return entry
        if waiting := self._waiting.get(entry.correction.id):
            try:
                async with asyncio.timeout(timeout_s):
                    return await asyncio.shield(waiting)
            except TimeoutError:
                return entry
        return entry


def _unheard(entry: Entry) -> None:
    del entry  # Nobody listens before `start`.


def _same(entry: Entry, digest: str) -> Entry:
    if entry.digest != digest:
        raise Problem(
            409,
            "id-used",
            "The id was used for something else",
            f"{entry.correction.id!r} named a different correction before; "
            "send the same one again, or take a new id",
        )
    return entry
