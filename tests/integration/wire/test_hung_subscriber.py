"""Somebody who hangs or dies is noticed, and holds up nobody else."""

import hashlib
import os
import signal
import time

import pytest

from shared.errors import NoAnswerError
from shared.messages.policy import TensorRef
from shared.wire.keys import chunk_key, robot_key, service_key
from shared.wire.tensors import CHUNK_BYTES, TensorFetcher, TensorPublisher
from tests.integration.wire.listener import ALIVE
from tests.integration.wire.processes import Child, answered, until

FRAME = robot_key("lab", "robot-1", "frame-top")
TENSOR = service_key("lab", "learner", "l-1", "tensor")
PERIOD_S = 0.02
PUTS = 100


@pytest.fixture
def lives(router):
    """What is told of the listener: True when it comes, False when it goes."""
    told = []
    with router.bus() as bus:
        bus.watch_alive(ALIVE, lambda _key, alive: told.append(alive))
        yield told


@pytest.fixture
def listener(router, lives):
    with Child("tests.integration.wire.listener", str(router.port), "hld/**") as child:
        until(lambda: lives == [True], 20)
        yield child


def put_frames(bus):
    """Pictures at 50 a second; how long the slowest put took."""
    slowest_s = 0.0
    for _ in range(PUTS):
        begun = time.monotonic()
        bus.put(FRAME, bytes(100_000), droppable=True)
        took_s = time.monotonic() - begun
        slowest_s = max(slowest_s, took_s)
        time.sleep(max(0.0, PERIOD_S - took_s))
    return slowest_s


def test_a_hung_watcher_stalls_neither_the_writer_nor_the_others(router, listener):
    heard = []
    with router.bus() as healthy, router.bus() as writer:
        healthy.subscribe(FRAME, lambda _key, data: heard.append(data), capacity=PUTS)
        until(lambda: writer.watched(FRAME))
        listener.signal(signal.SIGSTOP)
        assert put_frames(writer) < 0.5
        until(lambda: len(heard) > 0.8 * PUTS)


def test_a_hung_robot_holds_up_neither_the_learner_nor_the_tensors_of_the_others(router, listener):
    data = {hashlib.sha256(part).hexdigest(): part for part in [os.urandom(32 * CHUNK_BYTES)]}
    refs = [
        TensorRef(name="t", sha256=name, dtype="uint8", shape=(len(part),), size_bytes=len(part))
        for name, part in data.items()
    ]
    with router.bus() as healthy, router.bus() as learner:
        with (
            TensorPublisher(learner, TENSOR) as publisher,
            TensorFetcher(healthy, TENSOR, {}) as fetcher,
        ):
            until(lambda: learner.watched(chunk_key(TENSOR, refs[0].sha256, 0)))
            listener.signal(signal.SIGSTOP)
            begun = time.monotonic()
            publisher.publish(data)
            assert time.monotonic() - begun < 1
            assert fetcher.fetch(refs, 20) == data
            assert time.monotonic() - begun < 8


def test_a_put_that_waits_for_a_hung_reader_waits_a_second_and_reaches_the_others(router, listener):
    heard = []
    with router.bus() as healthy, router.bus() as writer:
        healthy.subscribe(FRAME, lambda _key, data: heard.append(data))
        until(lambda: writer.watched(FRAME))
        listener.signal(signal.SIGSTOP)
        begun = time.monotonic()
        for _ in range(48):
            writer.put(FRAME, bytes(CHUNK_BYTES))
        assert time.monotonic() - begun < 5
        until(lambda: len(heard) == 48)


def test_questions_end_in_time_while_the_router_hangs(router):
    with router.bus() as asker, router.bus() as server:
        server.serve("a", lambda _key, _data: b"ok")
        until(lambda: answered(asker))
        router.signal(signal.SIGSTOP)
        begun = time.monotonic()
        with pytest.raises(NoAnswerError):
            asker.ask("a", timeout_s=0.3)
        assert time.monotonic() - begun < 10
        router.signal(signal.SIGCONT)
        until(lambda: answered(asker))


def test_a_bus_ends_though_its_router_hangs(router):
    bus = router.bus()
    bus.subscribe("a", print)
    router.signal(signal.SIGSTOP)
    begun = time.monotonic()
    bus.close()
    assert time.monotonic() - begun < 6
    assert not bus.connected


def test_who_is_killed_is_gone_at_once(listener, lives):
    listener.kill()
    until(lambda: lives == [True, False], 1.0)


def test_who_hangs_is_gone_after_its_lease(listener, lives):
    listener.signal(signal.SIGSTOP)
    begun = time.monotonic()
    until(lambda: lives == [True, False])
    assert 0.5 < time.monotonic() - begun < 6.0
