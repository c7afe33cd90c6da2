"""Put a learner together: the one file that names concrete classes."""

from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from services.learner.collect import Collector
from services.learner.config import LearnerSettings
from services.learner.frozen import FrozenLowLevel
from services.learner.gate import Gate
from services.learner.lessons import Lessons
from services.learner.loop import Learner
from services.learner.process import TrainProcess
from services.learner.publish import Publisher
from services.learner.shelf import Shelf
from services.learner.store.archive import Archive
from services.learner.store.sql import SqlStore, sqlite_url
from services.learner.store.store import Marks, PolicyRecord
from services.learner.store.tensors import TensorFiles
from services.learner.tell import Teller
from services.learner.trials import Trials
from services.learner.turn import Parts
from shared.clock import SystemClock
from shared.errors import PolicyError
from shared.policies.checkpoint import bundled, load
from shared.wire.bus import open_bus

STORE_FILE = "learner.db"


@contextmanager
def learner(settings: LearnerSettings) -> Iterator[Learner]:
    """A learner with real parts; they are given back at the end.

    Raises:
        ConfigError: an endpoint of the bus can't be used.
        PolicyError: a checkpoint is missing or broken.
    """
    clock, fleet = SystemClock(), settings.bus.fleet
    data = settings.data.absolute()
    files = TensorFiles(data / "tensors")
    shelf = Shelf(data / "versions", files)
    frozen = FrozenLowLevel(settings.low_level or bundled("low_level"))
    url = settings.store or sqlite_url(data / STORE_FILE)
    (data / "settings.json").write_text(settings.model_dump_json(indent=2) + "\n")
    with open_bus(settings.bus) as bus:
        store = SqlStore(url)
        try:
            parts = Parts(
                bus=bus,
                store=store,
                collector=Collector(bus, fleet, store, clock),
                trainer=TrainProcess(
                    url, data / "tensors", settings.demonstrations, settings.low_level
                ),
                gate=Gate(settings.gate, Trials(bus, fleet, store, settings.gate.trials, clock)),
                publisher=Publisher(bus, fleet, settings.id, files, shelf),
                frozen=frozen,
                lessons=Lessons(bus, fleet, settings.id, store),
                clock=clock,
            )
            made = Learner(
                parts,
                settings,
                lambda: origin(settings.high_level, files, frozen.sha256, clock.now_ns()),
            )
            with (
                closing(Archive(url)) as archive,
                closing(Teller(bus, fleet, settings.id, archive)),
            ):
                yield made
        finally:
            store.close()


def origin(
    folder: Path | None, files: TensorFiles, low_level_sha256: str, now_ns: int
) -> PolicyRecord:
    """What a fresh store starts from: a checkpoint, as version number 0.

    Raises:
        PolicyError: the folder holds no high level.
    """
    folder = folder or bundled("high_level")
    tensors, card = load(folder)
    if "bank" not in card.settings:
        raise PolicyError(f"{folder} holds no high level: its card has no bank of phrases")
    return PolicyRecord(
        number=0,
        epoch=0,
        tensors=tuple(files.add(name, tensors[name]) for name in sorted(tensors)),
        bank=tuple(str(card.settings["bank"]).split("\n")),
        settings={name: value for name, value in card.settings.items() if name != "bank"},
        low_level_sha256=low_level_sha256,
        marks=Marks(),
        created_ns=now_ns,
    )
