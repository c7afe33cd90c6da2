"""News: tells open pages and waiting clients what has changed. A change only marks what is to be
sent; it is put into words when it is sent, so that a page that falls behind skips to the newest."""

import asyncio
from collections.abc import Iterable

from services.correction_api.live import Slot
from services.correction_api.parts import Parts
from services.correction_api.show import (
    event,
    show_correction,
    show_decision,
    show_help,
    show_learner,
    show_robot,
)
from services.correction_api.store.log import Entry
from services.correction_api.views import Presence

LOOK_S = 0.5
GREETED_AUTHORS = 200


class News:
    """Where changes become messages for pages."""

    def __init__(self, parts: Parts) -> None:
        self._parts = parts
        self._presences: dict[str, Presence] = {}
        for entry in parts.log.page(None, None, GREETED_AUTHORS, None):
            parts.authors.add(entry.correction.id, entry.correction.author)

    def changed(self, kind: str, name: str) -> None:
        """Something on the watch's board changed. Any thread."""
        match kind:
            case "robot":
                self._robot(name)
                self._call(name)
            case "decision":
                self._parts.bell.ring()
                self._robot(name)
                self._decision(name)
                self._call(name)
            case "episode":
                episode = event("episode", lambda: {"robot": name})
                self._parts.live.offer(Slot("episode", name), episode)
            case _:
                learner = event("learner", lambda: show_learner(self._parts))
                self._parts.live.offer(Slot("learner"), learner)

    def called(self) -> None:
        """A call for help began, changed or ended. Any thread."""
        self._parts.live.offer(Slot("help"), event("help", lambda: show_help(self._parts)))

    def spoken(self, entry: Entry) -> None:
        """A correction was kept or closed. Event loop's thread only."""
        self._parts.authors.add(entry.correction.id, entry.correction.author)
        view = event("correction", lambda: show_correction(self._parts, entry))
        self._parts.live.offer(Slot("correction", entry.correction.id), view)

    def learned(self, entries: Iterable[Entry]) -> None:
        """The learner told of corrections. Event loop's thread only."""
        for entry in entries:
            self.spoken(entry)

    async def mind(self) -> None:
        """Notice for ever who fell silent, since silence sends no message; nor is this service."""
        while True:
            self._parts.live.offer(Slot("beat"), event("beat", dict))
            for name in self._parts.watch.names():
                presence, _ = self._parts.watch.presence(self._parts.watch.look(name).heard_ns)
                if self._presences.get(name) != presence:
                    self._presences[name] = presence
                    self._robot(name)
                    self.called()  # Who has fallen silent asks for nothing.
            await asyncio.sleep(LOOK_S)

    def _robot(self, name: str) -> None:
        view = event("robot", lambda: show_robot(self._parts, name))
        self._parts.live.offer(Slot("robot", name), view)

    def _call(self, name: str) -> None:
        """What is shown with a call for help changes with its robot, and its time runs."""
        if any(call.robot == name for call in self._parts.calls.queue()):
            self.called()

    def _decision(self, name: str) -> None:
        decision = self._parts.watch.look(name).decision
        if decision:
            view = event("decision", lambda: show_decision(decision))
            self._parts.live.offer(Slot("decision", name), view)
