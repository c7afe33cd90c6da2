"""A learner on a table: real bus fake, store and publisher, and a trainer that a test owns."""

from pathlib import Path

import numpy as np

from services.learner.collect import Collector
from services.learner.config import LearnerSettings
from services.learner.frozen import FrozenLowLevel
from services.learner.gate import Candidate, Figures, Gate, GateSettings
from services.learner.lessons import Lessons
from services.learner.loop import Learner
from services.learner.publish import Publisher
from services.learner.rounds import RoundSettings
from services.learner.shelf import Shelf
from services.learner.store.memory import MemoryStore
from services.learner.store.store import Marks, PolicyRecord, Round
from services.learner.store.tensors import TensorFiles
from services.learner.trials import Trials
from services.learner.turn import Parts
from shared.clock import ManualClock
from shared.errors import PolicyError
from shared.messages.heartbeat import LearnerState
from shared.messages.policy import PolicyAnnouncement, TensorRef
from shared.wire.codec import decode
from shared.wire.hub import MemoryRouter
from shared.wire.keys import service_key
from shared.wire.memory import MemoryBus
from tests.unit.learner.checkpoints import small_low_level
from tests.unit.learner.records import HAM, correction, decision, episode, receipt

SECOND = 1_000_000_000


class FakeTrainer:
    """Trains when it is told that it has."""

    def __init__(self) -> None:
        self.begun: list[Round] = []
        self.forgotten: list[int] = []
        self.outcome: Candidate | PolicyError | None = None
        self.stopped = 0

    def demonstrations(self) -> str:
        return "d" * 64

    def start(self, round_: Round) -> None:
        self.begun.append(round_)

    def progress(self) -> float:
        return 0.5

    def result(self) -> Candidate | None:
        outcome, self.outcome = self.outcome, None
        if isinstance(outcome, PolicyError):
            raise outcome
        return outcome

    def stop(self) -> None:
        self.stopped += 1

    def forget(self, round_: Round) -> None:
        self.forgotten.append(round_.number)


class Bench:
    """A learner on a table, with all that a test turns."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.router, self.clock, self.store = MemoryRouter(), ManualClock(), MemoryStore()
        self.files = TensorFiles(folder / "tensors")
        self.low_level = small_low_level(folder)
        self.low_sha256 = FrozenLowLevel(self.low_level).sha256
        self.robots = MemoryBus(self.router)
        self.trainer = FakeTrainer()
        self.learner = self.restart()

    def restart(self, gate: GateSettings | None = None, **round_: int) -> Learner:
        """Another learner process on the same store."""
        gate = gate or GateSettings()
        bus = MemoryBus(self.router)
        self.trainer = FakeTrainer()
        settings = LearnerSettings(round=RoundSettings(**{"corrections": 2, **round_}), gate=gate)
        parts = Parts(
            bus=bus,
            store=self.store,
            collector=Collector(bus, "lab", self.store, self.clock),
            trainer=self.trainer,
            gate=Gate(gate, Trials(bus, "lab", self.store, gate.trials, self.clock)),
            publisher=Publisher(
                bus, "lab", "learner", self.files, Shelf(self.folder / "versions", self.files)
            ),
            frozen=FrozenLowLevel(self.low_level),
            lessons=Lessons(bus, "lab", "learner", self.store),
            clock=self.clock,
        )
        self.learner = Learner(parts, settings, self.origin)
        self.learner.start()
        return self.learner

    def origin(self) -> PolicyRecord:
        return PolicyRecord(
            number=0,
            epoch=0,
            tensors=(self.tensor(0.0),),
            bank=("wait",),
            settings={"width": 4},
            low_level_sha256=self.low_sha256,
            marks=Marks(),
            created_ns=1,
        )

    def tensor(self, value: float) -> TensorRef:
        data = np.full(4, value, np.float32).tobytes()
        sha256 = self.files.put(data)
        return TensorRef(name="w", sha256=sha256, dtype="float32", shape=(4,), size_bytes=16)

    def candidate(
        self,
        value: float = 1.0,
        finite: bool = True,
        learned: tuple[str, ...] = (),
        held_out: int = 20,
    ) -> Candidate:
        figures = Figures(
            labels=2,
            labels_sha256="0" * 64,
            held_out=held_out,
            before=0.5,
            after=0.9,
            loss=0.1,
            finite=finite,
            seconds=1.0,
        )
        return Candidate(
            tensors=(self.tensor(value),),
            bank=("wait", HAM),
            settings={"width": 4},
            figures=figures,
            learned=learned,
        )

    def happens(self, name: str, overrides: int = 2, missing: int = 0) -> None:
        """An episode with so many overrides, of which the last ones have not arrived yet."""
        for number in range(overrides):
            self.store.add(decision(name, number * 20), self.clock.now_ns())
        for number in range(overrides - missing):
            self.store.add(correction(f"{name}-{number}", HAM, episode=name), self.clock.now_ns())
            answer = receipt(f"{name}-{number}", number * 20, episode=name)
            self.store.add(answer, self.clock.now_ns())
        done = episode(name, decisions=overrides, corrections=overrides)
        self.store.add(
            done.model_copy(update={"low_level_sha256": self.low_sha256}), self.clock.now_ns()
        )

    def beat(self, seconds: float = 1.0) -> None:
        self.clock.advance(int(seconds * SECOND))
        self.learner.tick()

    def announced(self) -> PolicyAnnouncement:
        key = service_key("lab", "learner", "learner", "policy")
        return decode(PolicyAnnouncement, self.robots.ask(key))

    def state(self) -> LearnerState:
        return self.learner.heartbeat().state
