"""Live: what open pages get pushed; each has a bounded queue in which the newest wins.

A page that reads slowly gets fewer pictures and fewer states in between. It never holds up the
bus, another page, or a robot.
"""

import threading
from collections import OrderedDict
from collections.abc import Callable, Iterable
from typing import NamedTuple

from services.correction_api.bell import Bell
from shared.messages.frame import Rate

CAPACITY = 512
WINDOW = 32  # messages that may be under way to a page that says how many it has taken in

Content = str | bytes
Render = Callable[[], Content | None]


class Slot(NamedTuple):
    """A place in the queue: what comes later for the same slot replaces what waits there."""

    kind: str
    name: str = ""
    camera: str = ""


class View(NamedTuple):
    """One camera of one robot, looked at all the time or only now and then."""

    robot: str
    camera: str
    rate: Rate = Rate.FULL


class Client:
    """One open page: what waits to be sent to it, and the cameras that it looks at.

    A page that is busy would let messages pile up in its browser, where nothing replaces them. So
    one that tells what it has taken in gets no more than `WINDOW` beyond that.

    name: who sits before it, if they said so. focus: the robot that they have before them.
    """

    def __init__(self, bell: Bell, dropped: Callable[[str], None], name: str | None = None) -> None:
        self.bell = bell
        self.name = name
        self.focus: str | None = None
        self.views: frozenset[View] = frozenset()
        self._dropped = dropped
        self._waiting: OrderedDict[Slot, Render] = OrderedDict()
        self._sent = 0
        self._taken: int | None = None
        self._lock = threading.Lock()

    def acknowledge(self, taken: int) -> None:
        """The page has taken in so many messages since it was opened. Any thread."""
        with self._lock:
            self._taken = taken
        self.bell.ring()

    @property
    def counts(self) -> bool:
        """It tells what it has taken in, and so that it is there."""
        return self._taken is not None

    def offer(self, slot: Slot, render: Render) -> None:
        """Queue something; `render` is called when it is sent. Any thread."""
        with self._lock:
            if slot in self._waiting:
                self._dropped(slot.kind)
            elif len(self._waiting) >= CAPACITY:
                oldest, _ = self._waiting.popitem(last=False)
                self._dropped(oldest.kind)
            self._waiting[slot] = render  # A slot keeps its place, so that none starves.
        self.bell.ring()

    def take(self) -> Content | None:
        """The next thing to send, rendered now; None when nothing waits."""
        while True:
            with self._lock:
                full = self._taken is not None and self._sent - self._taken >= WINDOW
                if full or not self._waiting:
                    return None
                _, render = self._waiting.popitem(last=False)
            if (content := render()) is not None:
                self._sent += 1
                return content

    def __len__(self) -> int:
        return len(self._waiting)


class Live:
    """All open pages."""

    def __init__(self) -> None:
        self._wanted: Callable[[frozenset[View]], None] = _unheard
        self._clients: tuple[Client, ...] = ()
        self._lock = threading.Lock()

    def on_look(self, wanted: Callable[[frozenset[View]], None]) -> None:
        """Have `wanted(views)` called whenever the cameras that pages look at change."""
        self._wanted = wanted

    def join(self, client: Client) -> None:
        """A page was opened."""
        with self._lock:
            self._clients += (client,)

    def leave(self, client: Client) -> None:
        """A page was closed."""
        with self._lock:
            self._clients = tuple(other for other in self._clients if other is not client)
        self._want()

    def look(self, client: Client, views: Iterable[View]) -> None:
        """A page looks at these cameras now, and at no others."""
        client.views = frozenset(views)
        self._want()

    def offer(self, slot: Slot, render: Render) -> None:
        """Send to every page. Any thread."""
        for client in self._clients:
            client.offer(slot, render)

    def show(self, view: View, picture: bytes) -> None:
        """Send a picture to the pages that look at this camera. Any thread."""
        slot = Slot("frame", view.robot, view.camera)
        for client in self._clients:
            if view in client.views:
                client.offer(slot, lambda: picture)

    def people(self) -> dict[str, set[str]]:
        """Who is here, by name: the robots that they have in focus, over all their pages."""
        here: dict[str, set[str]] = {}
        for client in self._clients:
            if client.name is not None:
                robots = here.setdefault(client.name, set())
                robots.update([client.focus] if client.focus else ())
        return here

    def waiting(self) -> int:
        """How much waits to be sent, to all pages together."""
        return sum(len(client) for client in self._clients)

    def __len__(self) -> int:
        return len(self._clients)

    def _want(self) -> None:
        self._wanted(frozenset().union(*(client.views for client in self._clients)))


def _unheard(views: frozenset[View]) -> None:
    del views  # Nobody turns cameras before `on_look`.
