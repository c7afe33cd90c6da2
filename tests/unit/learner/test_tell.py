"""What the learner tells of its store: bounded, without what is not for people, and never wrong."""

from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest
import simplejpeg

from services.learner.store.archive import Archive
from services.learner.store.sql import SqlStore, sqlite_url
from services.learner.tell import Teller
from shared.errors import RefusedError
from shared.messages.lineage import Lineage
from shared.messages.message import Message
from shared.messages.recording import MAX_DECISIONS, Recording, RecordingQuery, Still, StillQuery
from shared.wire.bus import Bus
from shared.wire.codec import decode, encode
from shared.wire.keys import any_service
from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.keeper import UNJUDGED, turn_rounds
from tests.unit.learner.records import decision, ruling


@pytest.fixture
def store(tmp_path: Path) -> Iterator[SqlStore]:
    with closing(SqlStore(sqlite_url(tmp_path / "learner.db"))) as store:
        yield store


@pytest.fixture
def bus(store: SqlStore, tmp_path: Path) -> Iterator[Bus]:
    """A bus at which the teller of `store` answers."""
    del store  # It has made the tables.
    router = MemoryRouter()
    with (
        closing(Archive(sqlite_url(tmp_path / "learner.db"))) as archive,
        MemoryBus(router) as learner,
        closing(Teller(learner, "lab", "learner", archive)),
        MemoryBus(router) as asking,
    ):
        yield asking


def ask(bus: Bus, name: str, query: Message | None = None) -> bytes:
    return bus.ask(any_service("lab", "learner", name), encode(query) if query else b"")


def test_a_long_episode_is_told_in_parts_in_the_order_of_its_steps(
    store: SqlStore, bus: Bus
) -> None:
    count = MAX_DECISIONS + 5
    for index in reversed(range(count)):
        store.add(decision("e-1", 20 * index, index=index, truth={"held": "ham"}), 1)
    first = decode(Recording, ask(bus, "recording", RecordingQuery(episode="e-1")))
    assert (len(first.decisions), first.next) == (MAX_DECISIONS, MAX_DECISIONS)
    query = RecordingQuery(episode="e-1", first=MAX_DECISIONS)
    rest = decode(Recording, ask(bus, "recording", query))
    steps = [one.step for one in (*first.decisions, *rest.decisions)]
    assert steps == [20 * index for index in range(count)]
    assert (rest.next, rest.robot) == (None, "robot-1")
    assert "ham" not in first.model_dump_json()


def test_of_an_episode_that_is_not_here_nothing_is_told(store: SqlStore, bus: Bus) -> None:
    del store
    none = decode(Recording, ask(bus, "recording", RecordingQuery(episode="e-9")))
    assert (none.decisions, none.robot, none.next) == ((), None, None)


def test_a_still_is_what_that_camera_showed(store: SqlStore, bus: Bus) -> None:
    store.add(decision("e-1", 120), 1)
    still = decode(Still, ask(bus, "still", StillQuery(decision="e-1-120", camera="top")))
    picture = simplejpeg.decode_jpeg(still.arrays["jpeg"].tobytes())
    assert picture.shape == (64, 64, 3)
    assert abs(int(picture.mean()) - 120) <= 2
    for query, reason in (
        (StillQuery(decision="e-1-0", camera="top"), "no decision e-1-0"),
        (StillQuery(decision="e-1-120", camera="wrist"), "there are top, angle"),
    ):
        with pytest.raises(RefusedError, match=reason):
            ask(bus, "still", query)


def test_the_lineage_has_rounds_versions_and_rulings_without_what_they_are_made_of(
    store: SqlStore, bus: Bus
) -> None:
    with pytest.raises(RefusedError, match="no version yet"):
        ask(bus, "lineage")
    turn_rounds(store)
    store.add(ruling("rule-1", reason="it drops the bread"), 5)
    told = decode(Lineage, ask(bus, "lineage"))
    assert (str(told.version), [one.round for one in told.versions]) == ("1.1", [None, 1])
    passed, refused = told.rounds
    assert passed.trials is not None
    assert (passed.trials.before.share, passed.trials.after.share) == (0.52, 0.71)
    assert (passed.trials.after.n, passed.trials_p, passed.promotable) == (200, 0.0002, False)
    assert (passed.unjudged, refused.unjudged) == (UNJUDGED, "")
    assert refused.held_out is not None
    assert (refused.held_out.after.n, refused.promotable) == (40, True)
    (ruled,) = told.rulings
    assert (ruled.ruling.reason, ruled.answered_ns) == ("it drops the bread", None)
