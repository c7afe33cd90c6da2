"""Lexicon: what the robots' low level understands; asked before words about the past are kept.

What is said now the robot itself refuses, by its receipt. Of the past no robot has to hear, so a
phrase that nobody can obey would be learned and proposed: here it is asked about. The bank of a
policy can't tell, since it holds whatever was said before.
"""

import asyncio
from collections.abc import Iterator

from services.correction_api.views import Presence
from services.correction_api.watch import Watch
from shared.errors import HldError
from shared.messages.phrase import PhraseAnswer, PhraseQuestion
from shared.wire.bus import Bus
from shared.wire.codec import decode, encode
from shared.wire.keys import robot_key

ASK_S = 3.0  # On a busy machine robots read phrases when they have the time.
ASKED = 3
"""So many robots are asked until one answers."""
LOOK_S = 0.5


class Lexicon:
    """Asks robots; their commands are remembered, since a low level doesn't change."""

    def __init__(self, bus: Bus, fleet: str, watch: Watch) -> None:
        self._bus, self._fleet, self._watch = bus, fleet, watch
        self._commands: tuple[str, ...] = ()
        self._of = ""

    def ask(self, robot: str, text: str | None, *, anywhere: bool = False) -> PhraseAnswer:
        """What one robot says to a phrase, or what it knows. Waits for it.

        Raises:
            HldError: it doesn't answer, or can't now.
        """
        question = PhraseQuestion(robot=robot, text=text, anywhere=anywhere)
        key = robot_key(self._fleet, robot, "phrase")
        return decode(PhraseAnswer, self._bus.ask(key, encode(question), timeout_s=ASK_S))

    def understood(self, robot: str, text: str | None) -> PhraseAnswer | None:
        """What the low level of a robot makes of a phrase, whatever is in the scene.

        Another robot with the low level that versions are made for may answer instead. None:
        nobody could be asked.
        """
        for name in self._candidates(robot):
            try:
                answer = self.ask(name, text, anywhere=True)
            except HldError:
                continue
            if name == robot or answer.low_level_sha256 == self._wanted():
                return answer
        return None

    def commands(self) -> tuple[str, ...]:
        """All that the low level knows; nothing before a robot has told."""
        return self._commands

    async def learn(self) -> None:
        """Have a robot tell the commands, for ever: again when versions are for another one."""
        while True:
            if not self._commands or self._of != (self._wanted() or self._of):
                await asyncio.to_thread(self._learn)
            await asyncio.sleep(LOOK_S)

    def _learn(self) -> None:
        if answer := self.understood(next(iter(self._candidates("")), ""), None):
            self._commands, self._of = answer.commands, answer.low_level_sha256

    def _wanted(self) -> str:
        policy = self._watch.announcement
        return policy.low_level_sha256 if policy else ""

    def _candidates(self, robot: str) -> Iterator[str]:
        """The robot first, then others, as far as they are online."""
        names = sorted(self._watch.names(), key=lambda name: name != robot)
        online = (name for name in names if self._online(name))
        for name, _ in zip(online, range(ASKED), strict=False):
            yield name

    def _online(self, robot: str) -> bool:
        return self._watch.presence(self._watch.look(robot).heard_ns)[0] is Presence.ONLINE
