"""Tensors arrive whole and right, or not at all."""

import hashlib
import os
import threading
import time
import tracemalloc

import pytest

from shared.errors import MessageError, NoAnswerError, RefusedError
from shared.messages.policy import TensorRef
from shared.wire.keys import any_service, chunk_key, service_key
from shared.wire.memory import MemoryBus, MemoryRouter
from shared.wire.tensors import (
    CHUNK_BYTES,
    MAX_EARLY_BYTES,
    TensorFetcher,
    TensorPublisher,
    chunk_count,
    chunk_size,
)
from tests.integration.wire.processes import until

PREFIX = service_key("lab", "learner", "l-1", "tensor")


def named(*tensors):
    return {hashlib.sha256(data).hexdigest(): data for data in tensors}


def refs(tensors):
    return [
        TensorRef(name="t", sha256=name, dtype="uint8", shape=(len(data),), size_bytes=len(data))
        for name, data in tensors.items()
    ]


SMALL = named(b"abc", b"", b"defg")
LARGE = named(os.urandom(3 * CHUNK_BYTES + 5), os.urandom(2 * CHUNK_BYTES), os.urandom(1))


class LossyBus(MemoryBus):
    """Counts what is asked, and loses the puts that `loses` picks by their number."""

    def __init__(self, router, loses=lambda _number: False):
        super().__init__(router)
        self.loses, self.puts, self.asked = loses, 0, []

    def put(self, key, payload, *arguments, **options):
        self.puts += 1
        if not self.loses(self.puts - 1):
            super().put(key, payload, *arguments, **options)

    def ask(self, key, *arguments, **options):
        self.asked.append(key)
        return super().ask(key, *arguments, **options)


@pytest.fixture
def router():
    return MemoryRouter()


@pytest.fixture
def learner(router):
    with LossyBus(router) as bus:
        yield bus


@pytest.fixture
def actor(router):
    with LossyBus(router) as bus:
        yield bus


@pytest.fixture
def publisher(learner):
    with TensorPublisher(learner, PREFIX) as publisher:
        yield publisher


@pytest.fixture
def fetcher(actor):
    with TensorFetcher(actor, PREFIX, {}) as fetcher:
        yield fetcher


def heard_all(learner, actor):
    """A subscriber's queue is emptied by its own thread; wait until that is so."""
    marks = []
    actor.subscribe("mark", lambda _key, data: marks.append(data))
    learner.put("mark", b"")
    until(lambda: marks)


@pytest.mark.parametrize(
    ("size", "sizes"),
    [
        (0, []),
        (1, [1]),
        (CHUNK_BYTES, [CHUNK_BYTES]),
        (CHUNK_BYTES + 1, [CHUNK_BYTES, 1]),
        (3 * CHUNK_BYTES, [CHUNK_BYTES] * 3),
    ],
)
def test_a_tensor_is_cut_without_a_rest(size, sizes):
    assert [chunk_size(size, index) for index in range(chunk_count(size))] == sizes


def test_what_was_pushed_is_not_asked_for(actor, publisher, fetcher):
    assert publisher.publish(LARGE) == sum(map(len, LARGE.values()))
    until(lambda: fetcher._early.get(list(LARGE)[-1], 0))
    assert fetcher.fetch(refs(LARGE), 5) == LARGE
    assert actor.asked == []


def test_who_comes_late_asks_for_everything(actor, publisher):
    publisher.publish(LARGE)
    with TensorFetcher(actor, PREFIX, {}) as late:
        assert late.fetch(refs(LARGE), 5) == LARGE
    assert len(actor.asked) == 4 + 2 + 1


def test_any_learner_may_answer_when_the_prefix_says_so(actor, publisher):
    publisher.publish(LARGE)
    with TensorFetcher(actor, any_service("lab", "learner", "tensor"), {}) as late:
        assert late.fetch(refs(LARGE), 5) == LARGE


@pytest.mark.parametrize("lost", [[0], [2], [6], [0, 3, 5], range(7)])
def test_exactly_the_lost_chunks_are_asked_for(learner, actor, publisher, fetcher, lost):
    learner.loses = lambda number: number in lost
    publisher.publish(LARGE)
    learner.loses = lambda _number: False
    heard_all(learner, actor)
    assert fetcher.fetch(refs(LARGE), 5) == LARGE
    assert len(actor.asked) == len(lost)


def test_a_tensor_that_is_held_is_not_fetched(actor, publisher):
    publisher.publish(SMALL)
    with TensorFetcher(actor, PREFIX, SMALL) as fetcher:
        assert fetcher.fetch(refs(SMALL), 5) == SMALL
    assert actor.asked == []


def test_the_next_version_sends_only_what_changed(learner, publisher, fetcher):
    publisher.publish(SMALL)
    fetcher.fetch(refs(SMALL), 5)
    following = dict(list(SMALL.items())[:2]) | named(b"new")
    sent = learner.puts
    assert publisher.publish(following) == len(b"new")
    assert learner.puts == sent + 1
    assert fetcher.fetch(refs(following), 5) == following


def test_the_version_before_is_still_answered_and_the_one_before_that_is_not(actor, publisher):
    first, second, third = named(b"1"), named(b"2"), named(b"3")
    for version in (first, second, third):
        publisher.publish(version)
    with TensorFetcher(actor, PREFIX, {}) as late:
        assert late.fetch(refs(second), 5) == second
        with pytest.raises(NoAnswerError, match=next(iter(first))):
            late.fetch(refs(first), 0.2)


def test_a_chunk_that_nobody_has_is_refused(actor, publisher):
    publisher.publish(SMALL)
    name = next(iter(SMALL))
    for key in (chunk_key(PREFIX, "ab" * 32, 0), chunk_key(PREFIX, name, 1)):
        with pytest.raises(RefusedError, match="no chunk"):
            actor.ask(key)
    with pytest.raises(RefusedError, match="is no index"):
        actor.ask(chunk_key(PREFIX, name, "x"))


def test_rubbish_under_the_right_name_is_thrown_away(learner, actor, publisher, fetcher):
    name, data = next(iter(LARGE.items()))
    rubbish = bytes(CHUNK_BYTES)
    learner.put(chunk_key(PREFIX, name, 0), rubbish)
    learner.put(chunk_key(PREFIX, name, 1), b"short")
    heard_all(learner, actor)
    publisher._current = LARGE
    assert fetcher.fetch(refs({name: data}), 5) == {name: data}


def test_a_tensor_that_never_comes_right_is_never_given_out(learner, fetcher):
    learner.serve(chunk_key(PREFIX, "*", "*"), lambda _key, _data: b"xyz")
    with pytest.raises(NoAnswerError, match="did not come in time"):
        fetcher.fetch(refs(named(b"abc")), 0.3)


def test_what_came_before_the_time_was_out_is_kept_for_the_next_try(learner, actor, fetcher):
    name, data = next(iter(LARGE.items()))
    learner.put(chunk_key(PREFIX, name, 0), data[:CHUNK_BYTES])
    heard_all(learner, actor)
    with pytest.raises(NoAnswerError):
        fetcher.fetch(refs({name: data}), 0.2)
    with TensorPublisher(learner, PREFIX) as publisher:
        publisher._current = {name: data}
        actor.asked.clear()
        assert fetcher.fetch(refs({name: data}), 5) == {name: data}
    assert chunk_key(PREFIX, name, 0) not in actor.asked


def test_nobody_there_ends_in_time(fetcher):
    begun = time.monotonic()
    with pytest.raises(NoAnswerError):
        fetcher.fetch(refs(LARGE), 0.3)
    assert time.monotonic() - begun < 3


def test_a_publisher_that_comes_later_is_found(learner, fetcher):
    results = []
    thread = threading.Thread(target=lambda: results.append(fetcher.fetch(refs(LARGE), 10)))
    thread.start()
    with TensorPublisher(learner, PREFIX) as publisher:
        publisher.publish(LARGE)
        thread.join(15)
    assert results == [LARGE]


def test_a_version_beyond_reason_is_refused_before_anything_is_fetched(actor, fetcher):
    huge = [
        TensorRef(name="t", sha256=f"{n:064x}", dtype="uint8", shape=(1,), size_bytes=1 << 30)
        for n in range(2)
    ]
    tracemalloc.start()
    try:
        with pytest.raises(MessageError, match="too large: at most"):
            fetcher.fetch(huge, 5)
        assert tracemalloc.get_traced_memory()[1] < 100_000
    finally:
        tracemalloc.stop()
    assert actor.asked == []


def test_a_flood_of_chunks_that_nobody_wants_stays_within_its_limit(learner, actor, fetcher):
    for number in range(80):
        learner.put(chunk_key(PREFIX, f"{number:064x}", 0), bytes(CHUNK_BYTES))
    for index in range(100):
        learner.put(chunk_key(PREFIX, "ab" * 32, index), bytes(CHUNK_BYTES))
    learner.put(chunk_key(PREFIX, "cd" * 32, 0), bytes(CHUNK_BYTES + 1))
    learner.put(chunk_key(PREFIX, "no-hash", 0), b"")
    heard_all(learner, actor)
    assert fetcher._early.size_bytes <= MAX_EARLY_BYTES
    assert fetcher._early.get("cd" * 32, 0) is None
