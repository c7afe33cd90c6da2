"""What an actor takes up of what a learner announces: newer, whole, and meant for its robots."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from services.actor.refresh import Refresh
from services.learner.build import origin
from services.learner.publish import Publisher
from services.learner.shelf import Shelf
from services.learner.store.store import PolicyRecord
from services.learner.store.tensors import TensorFiles
from shared.policies.high_level import HighLevel
from shared.wire.hub import MemoryRouter
from shared.wire.memory import MemoryBus
from tests.integration.learner.process import until
from tests.unit.learner.checkpoints import Checkpoints, small_checkpoints

LOW = "a" * 64


@pytest.fixture(scope="module")
def checkpoints(tmp_path_factory: pytest.TempPathFactory) -> Checkpoints:
    return small_checkpoints(tmp_path_factory.mktemp("checkpoints"))


class Wire:
    """A learner's publisher, and an actor with two robots that follows it."""

    def __init__(self, folder: Path, checkpoints: Checkpoints) -> None:
        router = MemoryRouter()
        files = TensorFiles(folder / "tensors")
        shelf = Shelf(folder / "versions", files)
        self.publisher = Publisher(MemoryBus(router), "lab", "learner", files, shelf)
        self.base = origin(checkpoints.high_level, files, LOW, 1)
        start = HighLevel.load(checkpoints.high_level)
        self.refresh = Refresh(
            MemoryBus(router), "lab", start, LOW, folder / "kept", ("robot-1", "robot-2")
        )

    def announce(self, number: int, robots: tuple[str, ...] = (), low: str = LOW) -> PolicyRecord:
        record = self.base.model_copy(
            update={"number": number, "robots": robots, "low_level_sha256": low}
        )
        self.publisher.publish(record, epoch=1)
        return record

    def runs(self, robot: str, version: str) -> bool:
        return str(self.refresh.of(robot).newest.version) == version


@pytest.fixture
def wire(tmp_path: Path, checkpoints: Checkpoints) -> Iterator[Wire]:
    made = Wire(tmp_path, checkpoints)
    yield made
    made.refresh.close()
    made.publisher.close()


def test_a_newer_version_is_taken_up_by_all_robots_and_an_older_one_by_none(wire: Wire) -> None:
    wire.announce(3)
    until(lambda: wire.runs("robot-1", "1.3"), "1.3 is taken up")
    wire.announce(2)
    wire.announce(4)
    until(lambda: wire.runs("robot-2", "1.4"), "1.4 is taken up")
    assert wire.runs("robot-1", "1.4")


def test_a_version_for_some_robots_first_is_run_by_those_alone(wire: Wire) -> None:
    wire.announce(1)
    until(lambda: wire.runs("robot-2", "1.1"), "1.1 is taken up")
    wire.announce(2, robots=("robot-1",))
    until(lambda: wire.runs("robot-1", "1.2"), "robot-1 goes first")
    assert wire.runs("robot-2", "1.1")
    wire.announce(2)
    until(lambda: wire.runs("robot-2", "1.2"), "the others follow")


def test_what_is_taken_back_is_run_by_nobody_any_more(wire: Wire) -> None:
    wire.announce(2, robots=("robot-1",))
    until(lambda: wire.runs("robot-1", "1.2"), "robot-1 goes first")
    wire.announce(3)
    until(lambda: wire.runs("robot-1", "1.3"), "it goes back")
    assert wire.runs("robot-2", "1.3")


def test_a_version_for_robots_of_others_is_not_even_fetched(wire: Wire) -> None:
    wire.announce(2, robots=("robot-9",))
    wire.announce(3)
    until(lambda: wire.runs("robot-1", "1.3"), "1.3 is taken up")
    assert wire.refresh.refused == 0


def test_a_version_for_another_low_level_is_refused_and_counted(wire: Wire) -> None:
    wire.announce(2, low="b" * 64)
    until(lambda: wire.refresh.refused == 1, "it is refused")
    assert not wire.runs("robot-1", "1.2")
