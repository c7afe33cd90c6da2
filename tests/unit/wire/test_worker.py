"""The queue between the network and a handler: bounded, counted, and ended in good order."""

import threading
import time

import pytest

from shared.wire.worker import Worker
from tests.integration.wire.processes import until


@pytest.fixture
def gate():
    """Opened at the end, so that no worker waits for ever."""
    gate = threading.Event()
    yield gate
    gate.set()


def test_items_are_handled_one_after_the_other_in_a_thread_of_its_own():
    seen = []
    worker = Worker(
        "w", lambda item: seen.append((item, threading.current_thread().name)), capacity=100
    )
    for item in range(50):
        assert worker.offer(item)
    until(lambda: len(seen) == 50)
    assert seen == [(item, "w") for item in range(50)]
    worker.close()


@pytest.mark.parametrize(("newest", "kept"), [(True, [0, 3, 4]), (False, [0, 1, 2])])
def test_a_full_queue_counts_what_it_drops(gate, newest, kept):
    seen = []
    worker = Worker("w", lambda item: (seen.append(item), gate.wait(10)), capacity=2, newest=newest)
    worker.offer(0)
    until(lambda: seen)
    taken = [worker.offer(item) for item in range(1, 5)]
    assert taken == [True, True, newest, newest]
    assert worker.dropped == 2
    gate.set()
    until(lambda: seen == kept)
    worker.close()


def test_closing_waits_for_the_item_in_hand_and_forgets_the_rest(gate):
    begun, ended = [], []

    def handle(item):
        begun.append(item)
        gate.wait(10)
        ended.append(item)

    worker = Worker("w", handle, capacity=10)
    worker.offer(1)
    worker.offer(2)
    until(lambda: begun)
    threading.Timer(0.05, gate.set).start()
    worker.close()
    assert begun == ended == [1]
    assert not worker.offer(3)
    assert worker.dropped == 0


def test_closing_does_not_wait_for_ever(gate):
    worker = Worker("w", lambda _item: gate.wait(10), capacity=10)
    worker.offer(1)
    begun = time.monotonic()
    worker.close(timeout_s=0.05)
    assert time.monotonic() - begun < 5


def test_idle_is_called_when_nothing_comes_and_when_it_is_nudged():
    calls, seen = [], []
    idle = lambda: calls.append(time.monotonic())  # noqa: E731
    worker = Worker("w", seen.append, capacity=10, idle=idle, idle_s=0.02)
    until(lambda: len(calls) >= 3)
    worker.close()
    calls.clear()
    patient = Worker("w", seen.append, capacity=10, idle=idle, idle_s=1000)
    patient.nudge()
    until(lambda: len(calls) == 1)
    patient.offer(1)
    until(lambda: seen == [1])
    assert len(calls) == 1
    patient.close()


def test_a_queue_holds_at_least_one():
    with pytest.raises(ValueError, match="at least 1"):
        Worker("w", print, capacity=0)
