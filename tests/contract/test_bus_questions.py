"""What every bus promises of questions and answers."""

import threading
import time

import pytest

from shared.errors import NoAnswerError, RefusedError
from shared.wire.keys import any_robot, robot_key
from tests.contract.buses import answered, heard_by
from tests.integration.wire.processes import until


def test_an_answer_is_made_of_the_key_and_the_payload(bus, other, fleet, key):
    other.serve(any_robot(fleet, "decision"), lambda key, data: key.encode() + b"|" + data)
    assert answered(bus, key, b"what?") == key.encode() + b"|what?"


def test_questions_of_many_threads_get_each_their_own_answer(bus, other, key):
    other.serve(key, lambda _key, data: data * 2)
    answered(bus, key)
    answers = {}

    def ask(number):
        answers[number] = bus.ask(key, str(number).encode(), timeout_s=10)

    threads = [threading.Thread(target=ask, args=(number,)) for number in range(16)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(15)
    assert answers == {number: str(number).encode() * 2 for number in range(16)}


def test_those_who_serve_answer_one_question_at_a_time(bus, other, key):
    busy = threading.Lock()

    def handle(_key, _data):
        assert busy.acquire(blocking=False)
        time.sleep(0.002)
        busy.release()
        return b"ok"

    other.serve(key, handle)
    answered(bus, key)
    threads = [threading.Thread(target=lambda: bus.ask(key, timeout_s=10)) for _ in range(10)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(15)
    assert bus.ask(key) == b"ok"


def test_a_refusal_carries_its_reason(bus, other, key):
    def handle(_key, _data):
        raise RefusedError("episode e-1 is over; now runs e-2 – näher")

    other.serve(key, handle)
    with pytest.raises(RefusedError, match="episode e-1 is over; now runs e-2 – näher"):
        answered(bus, key)


def test_an_error_that_nobody_meant_tells_nothing_of_itself(bus, other, key):
    def handle(_key, _data):
        raise KeyError("secret")

    other.serve(key, handle)
    with pytest.raises(RefusedError, match=r"^internal error$"):
        answered(bus, key)


def test_an_answer_beats_a_refusal(bus, other, new_bus, key):
    def refuse(_key, _data):
        raise RefusedError("not me")

    third = new_bus()
    other.serve(key, refuse)
    third.serve(key, lambda _key, _data: b"me")

    def both():
        try:
            return bus.ask(key) == b"me"
        except (RefusedError, NoAnswerError):
            return False

    until(both)
    assert [bus.ask(key) for _ in range(20)] == [b"me"] * 20


def test_a_question_that_nobody_serves_ends_in_time(bus, key):
    begun = time.monotonic()
    with pytest.raises(NoAnswerError, match=key):
        bus.ask(key, timeout_s=0.5)
    assert time.monotonic() - begun < 8  # Far less than who hangs would take.


def test_a_question_to_somebody_who_hangs_ends_in_time(bus, other, key):
    go = threading.Event()
    other.serve(key, lambda _key, data: b"late" if data == b"hang" and go.wait(10) else b"ok")
    answered(bus, key)
    begun = time.monotonic()
    with pytest.raises(NoAnswerError, match=r"0\.2 s"):
        bus.ask(key, b"hang", timeout_s=0.2)
    assert 0.15 < time.monotonic() - begun < 8  # Far less than who hangs would take.
    go.set()


def test_a_question_that_finds_the_queue_full_is_not_answered(bus, other, key):
    go, entered = threading.Event(), threading.Event()

    def handle(_key, _data):
        entered.set()
        return b"late" if go.wait(10) else b"never"

    served = other.serve(key, handle, capacity=1)
    waiting = [threading.Thread(target=lambda: answered(bus, key), daemon=True) for _ in range(2)]
    waiting[0].start()
    assert entered.wait(10)
    waiting[1].start()

    def turned_away():
        with pytest.raises(NoAnswerError):
            bus.ask(key, timeout_s=0.1)
        return served.dropped > 0

    until(turned_away)
    go.set()
    for thread in waiting:
        thread.join(10)


def test_a_handler_may_ask_and_put_itself(bus, other, fleet, key):
    second = robot_key(fleet, "r-2", "decision")
    heard, _ = heard_by(bus, second)
    bus.serve(second, lambda _key, data: b"inner " + data)
    answered(other, second)

    def handle(_key, data):
        other.put(second, b"put")
        return other.ask(second, data)

    other.serve(key, handle)
    assert answered(bus, key, b"x") == b"inner x"
    until(lambda: heard)
