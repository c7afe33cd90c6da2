"""What every bus promises of a put, held against the fake and a real router of Zenoh."""

import threading

import pytest

from shared.errors import MessageError
from shared.wire.bus import MAX_BYTES
from shared.wire.keys import any_robot
from tests.contract.buses import heard_by, in_touch
from tests.integration.wire.processes import until


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
    flood(bus, other, key, 11, heard)
    go.set()
    until(lambda: heard[-1:] == [b"10"])
    assert heard == [b"0", b"7", b"8", b"9", b"10"]
    assert subscription.dropped == 6


def test_a_queue_that_keeps_the_oldest_drops_what_comes(bus, other, key):
    heard, subscription, go = stuck_subscription(other, key, newest=False)
    flood(bus, other, key, 11, heard)
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


def flood(bus, other, key, count, heard):
    """Put so many numbers; return when all have come to the other side. heard: the first is out of
    its queue before the others come."""
    witness, _ = heard_by(other, key)
    in_touch(bus, key)
    bus.put(key, b"0")
    until(lambda: witness and heard)
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
