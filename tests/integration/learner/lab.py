"""A learner process on a run folder, and what one can see of it from outside."""

from pathlib import Path

from services.learner.store.sql import SqlStore, sqlite_url
from shared.errors import NoAnswerError, RefusedError
from shared.messages.heartbeat import LearnerHeartbeat
from shared.messages.policy import PolicyAnnouncement
from shared.policies.checkpoint import load_card
from shared.wire.bus import INTERNAL_ERROR, Bus
from shared.wire.codec import decode
from shared.wire.keys import service_key
from tests.integration.learner.process import Process, until
from tests.integration.learner.world import Sent
from tests.unit.learner.checkpoints import Checkpoints


class Lab:
    """Starts, kills and restarts a learner, and listens to it."""

    def __init__(self, folder: Path, router: str, bus: Bus, checkpoints: Checkpoints) -> None:
        self.folder, self.bus = folder, bus
        self._router, self._checkpoints = router, checkpoints
        self.low_level_sha256 = load_card(checkpoints.low_level).tensors_sha256
        self.beats: list[LearnerHeartbeat] = []
        self.announced: list[PolicyAnnouncement] = []
        bus.subscribe(service_key("lab", "learner", "learner", "heartbeat"), self._hear)
        bus.follow(service_key("lab", "learner", "learner", "policy"), self._follow)
        self.learner: Process | None = None

    def start(self, **settings: object) -> Process:
        """A learner process; `round__corrections=2` sets `round.corrections`."""
        values: dict[str, object] = {
            "bus.connect": f'["{self._router}"]',
            "low_level": self._checkpoints.low_level,
            "high_level": self._checkpoints.high_level,
            "demonstrations": self._checkpoints.demonstrations,
            "train.batch": 8,
            "train.nice": 0,
            "train.threads": 1,  # Others test beside it.
            "gate.unjudged": "let-out",  # An episode or two are too few to judge by.
            **{name.replace("__", "."): value for name, value in settings.items()},
        }
        sets = [word for name, value in values.items() for word in ("--set", f"{name}={value}")]
        data = str(self.folder / "run")
        self.learner = Process(
            "services.learner", "--data", data, *sets, log=self.folder / "learner.log"
        )
        return self.learner

    def close(self) -> None:
        if self.learner is not None and self.learner.running:
            self.learner.kill()

    def send(self, sent: Sent) -> bool:
        """Ask once, as a courier does; whether it was acknowledged."""
        try:
            return self.bus.ask(sent.key, sent.payload, timeout_s=1.0) == b"ok"
        except NoAnswerError:
            return False
        except RefusedError as error:
            if str(error) != INTERNAL_ERROR:
                raise  # At any other refusal a courier gives up.
            return False

    def deliver(self, sent: Sent) -> None:
        """Ask until it is acknowledged."""
        until(lambda: self.send(sent), f"{sent.id} is acknowledged")

    def wait_for(self, version: str) -> PolicyAnnouncement:
        """Until this version is announced."""

        def look() -> PolicyAnnouncement | None:
            found = (one for one in self.announced if str(one.version) == version)
            return next(found, None)

        found: PolicyAnnouncement = until(look, f"version {version} is announced")
        return found

    def store(self) -> SqlStore:
        """The learner's store, from outside."""
        return SqlStore(sqlite_url(self.folder / "run" / "learner.db"))

    def _hear(self, key: str, payload: bytes) -> None:
        del key  # Unused: there is one learner.
        self.beats.append(decode(LearnerHeartbeat, payload))

    def _follow(self, key: str, payload: bytes) -> None:
        del key  # Unused, as above.
        self.announced.append(decode(PolicyAnnouncement, payload))
