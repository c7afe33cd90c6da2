"""What the learner takes in, and what it says to those who send."""

from collections.abc import Iterator

import pytest

from services.learner.collect import Collector
from services.learner.store.memory import MemoryStore
from services.learner.store.store import Manifest, Marks, Tally
from shared.clock import ManualClock
from shared.errors import RefusedError
from shared.messages.message import Message
from shared.seeds import DEMONSTRATION, EVALUATION, GATE
from shared.wire.codec import encode
from shared.wire.hub import MemoryRouter
from shared.wire.keys import robot_key, service_key
from shared.wire.memory import MemoryBus
from tests.unit.learner.records import HAM, TOAST, correction, decision, episode, receipt


@pytest.fixture
def store() -> MemoryStore:
    return MemoryStore()


@pytest.fixture
def bus(store: MemoryStore) -> Iterator[MemoryBus]:
    router = MemoryRouter()
    with MemoryBus(router) as learner, MemoryBus(router) as sender:
        Collector(learner, "lab", store, ManualClock()).start()
        yield sender


def robots(name: str, message: Message, robot: str = "robot-1") -> tuple[str, bytes]:
    return robot_key("lab", robot, name), encode(message)


def api(name: str, message: Message) -> tuple[str, bytes]:
    return service_key("lab", "correction-api", "api-7", name), encode(message)


SENT = [
    robots("decision", decision()),
    robots("episode", episode()),
    api("correction", correction("c", HAM)),
    api("receipt", receipt("c", 3)),
]


@pytest.mark.parametrize("sent", SENT, ids=lambda sent: sent[0].rsplit("/", 1)[1])
def test_each_message_is_kept_once_however_often_it_is_sent(
    bus: MemoryBus, store: MemoryStore, sent: tuple[str, bytes]
) -> None:
    assert [bus.ask(*sent) for _ in range(3)] == [b"ok"] * 3
    assert sum(store.survey(Manifest()).marks.model_dump().values()) == 1


def test_what_is_no_message_is_refused_with_the_reason(bus: MemoryBus) -> None:
    key, _ = SENT[1]
    with pytest.raises(RefusedError, match="no JSON"):
        bus.ask(key, b"not a message")


def test_another_body_under_a_known_id_is_refused(bus: MemoryBus) -> None:
    bus.ask(*api("correction", correction("c", HAM)))
    with pytest.raises(RefusedError, match="another correction has the id c"):
        bus.ask(*api("correction", correction("c", TOAST)))


@pytest.mark.parametrize("seed", [DEMONSTRATION.start, EVALUATION.start, GATE.stop - 1])
def test_an_episode_that_is_not_for_learning_is_refused(
    bus: MemoryBus, store: MemoryStore, seed: int
) -> None:
    with pytest.raises(RefusedError, match="seeds to learn from"):
        bus.ask(*robots("episode", episode(seed=seed)))
    assert store.tally(Marks()) == Tally()


def test_a_seed_out_of_every_range_is_refused(bus: MemoryBus) -> None:
    with pytest.raises(RefusedError, match="out of range"):
        bus.ask(*robots("episode", episode(seed=GATE.stop)))


def test_one_robot_cannot_speak_for_another(bus: MemoryBus) -> None:
    with pytest.raises(RefusedError, match="came as robot-2's"):
        bus.ask(*robots("decision", decision(), robot="robot-2"))
