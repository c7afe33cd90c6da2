"""What the buses of one process share: the fake's router, and what was asked of it."""

import threading
from typing import Any

from shared.wire import keys as names
from shared.wire.worker import Worker


class MemorySubscription:
    """What was asked of a `MemoryBus`."""

    def __init__(self, router: "MemoryRouter", kind: str, keys: str, worker: Worker[Any]) -> None:
        self._router = router
        self.kind = kind
        self.keys = names.check_pattern(keys)
        self.worker = worker
        router.add(self)

    @property
    def dropped(self) -> int:
        return self.worker.dropped

    def close(self) -> None:
        self._router.remove(self)
        self.worker.close()


class MemoryRouter:
    """What the buses of one process share. `stop` and `start` play a router that goes down:
    meanwhile puts are lost and questions get no answer, as with the real one."""

    def __init__(self) -> None:
        self._lock = threading.RLock()
        self._subscriptions: list[MemorySubscription] = []
        self._latest: dict[str, tuple[int, bytes]] = {}
        self._owners: dict[str, object] = {}
        self._alive: dict[str, int] = {}
        self._count = 0
        self.running = True

    def stop(self) -> None:
        """Go down."""
        with self._lock:
            self.running = False
            self._tell_alive(list(self._alive), False)

    def start(self) -> None:
        """Come back: followers get what they missed."""
        with self._lock:
            self.running = True
            self._tell_alive(list(self._alive), True)
            for key, value in self._latest.items():
                self._offer("follow", key, (key, *value))

    def add(self, subscription: MemorySubscription) -> None:
        with self._lock:
            self._subscriptions.append(subscription)
            if not self.running:
                return
            if subscription.kind == "alive":
                for key in self._matching(self._alive, subscription.keys):
                    subscription.worker.offer((key, True))
            if subscription.kind == "follow":
                for key in self._matching(self._latest, subscription.keys):
                    subscription.worker.offer((key, *self._latest[key]))

    def remove(self, subscription: MemorySubscription) -> None:
        with self._lock:
            if subscription in self._subscriptions:
                self._subscriptions.remove(subscription)

    def put(self, key: str, payload: bytes) -> None:
        with self._lock:
            if self.running:
                self._offer("put", key, (key, payload))
                self._offer("follow", key, (key, 0, payload))

    def keep(self, key: str, payload: bytes, owner: object) -> None:
        """Put a value and keep it for as long as its owner lives."""
        with self._lock:
            self._count += 1
            self._latest[key] = (self._count, payload)
            self._owners[key] = owner
            if self.running:
                self._offer("put", key, (key, payload))
                self._offer("follow", key, (key, self._count, payload))

    def kept(self, pattern: str) -> bytes | None:
        """The latest value of a key that matches, for `ask`."""
        with self._lock:
            found = self._matching(self._latest, pattern) if self.running else []
            return self._latest[found[0]][1] if found else None

    def forget(self, key: str, owner: object) -> None:
        """The owner goes; another one may have taken its place already."""
        with self._lock:
            if self._owners.get(key) is owner:
                del self._owners[key], self._latest[key]

    def servers(self, key: str) -> list[MemorySubscription]:
        return self._find("serve", key)

    def watched(self, key: str) -> bool:
        return bool(self._find("put", key) + self._find("follow", key))

    def live(self, key: str, change: int) -> None:
        """Count a sign of life up or down."""
        with self._lock:
            count = self._alive.get(key, 0)
            self._alive[key] = count + change
            if not self._alive[key]:
                del self._alive[key]
            if self.running and 0 in (count, count + change):
                self._tell_alive([key], count == 0)

    def _find(self, kind: str, key: str) -> list[MemorySubscription]:
        with self._lock:
            return [
                entry
                for entry in self._subscriptions
                if self.running and entry.kind == kind and names.intersects(entry.keys, key)
            ]

    def _offer(self, kind: str, key: str, item: tuple[Any, ...]) -> None:
        for entry in self._find(kind, key):
            entry.worker.offer(item)

    def _tell_alive(self, keys: list[str], lives: bool) -> None:
        for entry in self._subscriptions:
            for key in keys:
                if entry.kind == "alive" and names.intersects(entry.keys, key):
                    entry.worker.offer((key, lives))

    @staticmethod
    def _matching(known: dict[str, Any], pattern: str) -> list[str]:
        return [key for key in known if names.intersects(pattern, key)]
