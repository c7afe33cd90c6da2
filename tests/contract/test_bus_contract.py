"""What every bus promises, held against the fake and against Zenoh through a real router.

Each test has a place of its own on the bus, since those of Zenoh share one router.
"""

import itertools
import threading
import time

import pytest

from shared.errors import MessageError, NoAnswerError, RefusedError
from shared.wire.bus import MAX_BYTES
from shared.wire.keys import any_robot, any_service, robot_key, service_key
from tests.integration.wire.processes import until

_fleets = itertools.count()


@pytest.fixture
def fleet():
    return f"fleet-{next(_fleets)}"


@pytest.fixture
def key(fleet):
    return robot_key(fleet, "r-1", "decision")


def heard_by(bus, keys, **options):
    """What a new subscription hears, as a list that grows; the subscription."""
    heard = []
    subscription = bus.subscribe(keys, lambda key, data: heard.append((key, data)), **options)
    return heard, subscription


def in_touch(bus, key):
    until(lambda: bus.watched(key), what=f"{key} is watched")


def answered(bus, key, payload=b""):
    """Ask until somebody is there: a bus hears of those who serve within milliseconds."""
    answers = []

    def tried():
        try:
            answers.append(bus.ask(key, payload, timeout_s=1))
        except NoAnswerError:
            return False
        return True

    until(tried)
    return answers[0]


def test_a_put_reaches_every_subscriber_whose_pattern_matches(bus, other, fleet, key):
    one, _ = heard_by(other, key)
    many, _ = heard_by(other, any_robot(fleet, "decision"))
    none, _ = heard_by(other, any_robot(fleet, "episode"))
    in_touch(bus, key)
    bus.put(key, b"hello")
    until(lambda: one and many)
    assert one == many == [(key, b"hello")]
    assert none == []


def test_puts_of_one_writer_come_in_order(bus, other, key):
    heard, subscription = heard_by(other, key, capacity=1000)
    in_touch(bus, key)
    for number in range(500):
        bus.put(key, str(number).encode())
    until(lambda: len(heard) == 500)
    assert [int(data) for _, data in heard] == list(range(500))
    assert subscription.dropped == 0


def test_a_bus_hears_itself(bus, key):
    heard, _ = heard_by(bus, key)
    bus.put(key, b"x")
    until(lambda: heard)


def test_an_empty_and_a_largest_payload_travel_whole(bus, other, key):
    heard, _ = heard_by(other, key)
    in_touch(bus, key)
    largest = bytes(range(256)) * (MAX_BYTES // 256)
    bus.put(key, b"")
    bus.put(key, largest)
    until(lambda: len(heard) == 2)
    assert [data for _, data in heard] == [b"", largest]


@pytest.mark.parametrize("act", ["put", "ask", "latest"])
def test_a_payload_beyond_the_limit_is_refused_where_it_is_sent(bus, key, act):
    with pytest.raises(MessageError, match=str(MAX_BYTES)):
        getattr(bus, act)(key, bytes(MAX_BYTES + 1))


@pytest.mark.parametrize(
    "hostile", ["", "/", "a//b", "a/", "a/*", "a/**", "a/$*", "A", "a b", "a\n"]
)
def test_only_a_plain_key_can_be_written_to(bus, hostile):
    for act in (bus.put, bus.latest):
        with pytest.raises(MessageError):
            act(hostile, b"")
    with pytest.raises(MessageError):
        bus.alive(hostile)
    with pytest.raises(MessageError):
        bus.watched(hostile)


@pytest.mark.parametrize("hostile", ["", "/", "a//b", "a/$*", "a*", "a/?x=1", "***", "a#b", "a\n"])
def test_only_whole_chunks_can_be_wildcards(bus, hostile):
    for act in (bus.subscribe, bus.serve, bus.follow, bus.watch_alive):
        with pytest.raises(MessageError):
            act(hostile, print)
    with pytest.raises(MessageError):
        bus.ask(hostile)


def test_a_closed_subscription_hears_nothing_more(bus, other, key):
    heard, subscription = heard_by(other, key)
    witness, _ = heard_by(other, key)
    in_touch(bus, key)
    subscription.close()
    subscription.close()
    bus.put(key, b"late")
    until(lambda: witness)
    assert heard == []


def test_a_subscription_may_close_itself_in_its_handler(bus, key):
    heard = []

    def once(_key, data):
        heard.append(data)
        subscription.close()

    subscription = bus.subscribe(key, once)
    witness, _ = heard_by(bus, key)
    bus.put(key, b"1")
    until(lambda: len(witness) == 1)
    until(lambda: heard)
    bus.put(key, b"2")
    until(lambda: len(witness) == 2)
    assert heard == [b"1"]


def test_a_full_queue_drops_the_oldest_and_counts_them(bus, other, key):
    heard, subscription, go = stuck_subscription(other, key, newest=True)
    flood(bus, other, key, 11)
    go.set()
    until(lambda: heard[-1:] == [b"10"])
    assert heard == [b"0", b"7", b"8", b"9", b"10"]
    assert subscription.dropped == 6


def test_a_queue_that_keeps_the_oldest_drops_what_comes(bus, other, key):
    heard, subscription, go = stuck_subscription(other, key, newest=False)
    flood(bus, other, key, 11)
    go.set()
    until(lambda: heard[-1:] == [b"4"])
    assert heard == [b"0", b"1", b"2", b"3", b"4"]
    assert subscription.dropped == 6


def stuck_subscription(bus, key, newest):
    """A subscription with a queue of four, whose handler waits for `go`."""
    heard, go = [], threading.Event()

    def handle(_key, data):
        heard.append(data)
        assert go.wait(10)

    return heard, bus.subscribe(key, handle, capacity=4, newest=newest), go


def flood(bus, other, key, count):
    """Put so many numbers; return when all have come to the other side."""
    witness, _ = heard_by(other, key)
    in_touch(bus, key)
    bus.put(key, b"0")
    until(lambda: witness)
    for number in range(1, count):
        bus.put(key, str(number).encode())
    until(lambda: len(witness) == count)


def test_a_slow_handler_holds_up_nobody_else(bus, other, key):
    go = threading.Event()
    slow = other.subscribe(key, lambda _key, _data: go.wait(10))
    heard, _ = heard_by(other, key)
    in_touch(bus, key)
    for _ in range(20):
        bus.put(key, b"x")
    until(lambda: len(heard) == 20)
    go.set()
    slow.close()


def test_a_handler_that_fails_gets_the_next_message_all_the_same(bus, other, key):
    heard = []

    def handle(_key, data):
        heard.append(data)
        raise RuntimeError("on purpose")

    other.subscribe(key, handle)
    in_touch(bus, key)
    bus.put(key, b"1")
    bus.put(key, b"2")
    until(lambda: heard == [b"1", b"2"])


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
    assert time.monotonic() - begun < 1.5


def test_a_question_to_somebody_who_hangs_ends_in_time(bus, other, key):
    go = threading.Event()
    other.serve(key, lambda _key, data: b"late" if data == b"hang" and go.wait(10) else b"ok")
    answered(bus, key)
    begun = time.monotonic()
    with pytest.raises(NoAnswerError, match=r"0\.2 s"):
        bus.ask(key, b"hang", timeout_s=0.2)
    assert 0.15 < time.monotonic() - begun < 1.5
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


def policy_key(fleet, id="l-1"):
    return service_key(fleet, "learner", id, "policy")


def followed_by(bus, fleet):
    values = []
    bus.follow(any_service(fleet, "learner", "policy"), lambda _key, data: values.append(data))
    return values


def test_who_follows_late_gets_the_latest_and_then_what_is_newer(bus, other, fleet):
    bus.latest(policy_key(fleet), b"1")
    bus.latest(policy_key(fleet), b"2")
    until(lambda: answered(other, policy_key(fleet)) == b"2")
    values = followed_by(other, fleet)
    until(lambda: values == [b"2"])
    bus.latest(policy_key(fleet), b"3")
    until(lambda: values == [b"2", b"3"])


def test_who_follows_early_gets_what_comes_and_nothing_twice(bus, other, fleet):
    values = followed_by(other, fleet)
    sent = [str(number).encode() for number in range(20)]
    in_touch(bus, policy_key(fleet))
    for value in sent:
        bus.latest(policy_key(fleet), value)
    until(lambda: values == sent)
    second = followed_by(other, fleet)
    until(lambda: second == sent[-1:])
    assert values == sent


def test_each_writer_has_a_latest_value_of_its_own(bus, other, new_bus, fleet):
    bus.latest(policy_key(fleet, "l-1"), b"one")
    new_bus().latest(policy_key(fleet, "l-2"), b"two")
    values = followed_by(other, fleet)
    until(lambda: sorted(values) == [b"one", b"two"])


def test_the_latest_value_answers_a_question(bus, other, fleet):
    bus.latest(policy_key(fleet), b"1")
    assert answered(other, policy_key(fleet)) == b"1"
    assert answered(other, any_service(fleet, "learner", "policy")) == b"1"


def test_the_latest_value_goes_with_its_writer(bus, new_bus, fleet):
    writer = new_bus()
    writer.latest(policy_key(fleet), b"old")
    assert answered(bus, policy_key(fleet)) == b"old"
    writer.close()
    heir = new_bus()
    heir.latest(policy_key(fleet), b"new")
    until(lambda: answered(bus, policy_key(fleet)) == b"new")
    values = followed_by(bus, fleet)
    until(lambda: values == [b"new"])


def test_a_subscriber_and_a_follower_hear_each_other_s_kind_of_put(bus, other, fleet):
    heard, _ = heard_by(other, any_service(fleet, "learner", "policy"))
    values = followed_by(other, fleet)
    in_touch(bus, policy_key(fleet))
    bus.latest(policy_key(fleet), b"kept")
    bus.put(policy_key(fleet), b"plain")
    until(lambda: len(values) == len(heard) == 2)
    assert values == [b"kept", b"plain"]
    assert [data for _, data in heard] == [b"kept", b"plain"]


def test_a_key_is_watched_while_somebody_subscribes_to_it(bus, other, fleet, key):
    assert not bus.watched(key)
    _, subscription = heard_by(other, any_robot(fleet, "decision"))
    in_touch(bus, key)
    assert not bus.watched(robot_key(fleet, "r-1", "episode"))
    subscription.close()
    until(lambda: not bus.watched(key))


def test_who_is_alive_is_told_and_who_goes_too(bus, new_bus, fleet):
    early, late = new_bus(), new_bus()
    early.alive(service_key(fleet, "learner", "l-1", "alive"))
    seen = []
    bus.watch_alive(f"hld/v1/{fleet}/*/*/alive", lambda key, lives: seen.append((key, lives)))
    until(lambda: len(seen) == 1)
    late.alive(robot_key(fleet, "r-1", "alive"))
    until(lambda: len(seen) == 2)
    early.close()
    until(lambda: len(seen) == 3)
    assert seen == [
        (f"hld/v1/{fleet}/learner/l-1/alive", True),
        (f"hld/v1/{fleet}/actor/r-1/alive", True),
        (f"hld/v1/{fleet}/learner/l-1/alive", False),
    ]


def test_a_closed_bus_is_quiet(new_bus, other, key):
    bus = new_bus()
    assert bus.connected
    heard, _ = heard_by(bus, key)
    in_touch(other, key)
    bus.close()
    bus.close()
    assert not bus.connected
    assert not bus.watched(key)
    bus.put(key, b"x")
    until(lambda: not other.watched(key))
    other.put(key, b"x")
    for act in (bus.subscribe, bus.serve, bus.follow, bus.watch_alive):
        with pytest.raises(NoAnswerError, match="closed"):
            act(key, print)
    with pytest.raises(NoAnswerError):
        bus.ask(key)
    assert heard == []


def test_closing_leaves_no_thread_behind(new_bus, key):
    before = set(threading.enumerate())
    with new_bus() as bus:
        bus.subscribe(key, print)
        bus.serve(key, lambda _key, data: data)
        bus.follow(key, print)
        bus.latest(key, b"")
        bus.watch_alive(key, print)
        bus.alive(key)
    until(lambda: set(threading.enumerate()) <= before)
