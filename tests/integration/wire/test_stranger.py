"""A Zenoh client that isn't ours, on a bus of ours: it breaks nothing, whatever it sends."""

import json

import pytest
import zenoh

from shared.wire.bus import MAX_BYTES
from shared.wire.keys import any_robot, any_service, robot_key, service_key
from tests.integration.wire.processes import RouterProcess, answered, until

KEY = robot_key("lab", "robot-1", "decision")
POLICY = service_key("lab", "learner", "l-1", "policy")


@pytest.fixture(scope="module")
def router():
    """One for all: nothing here kills it."""
    with RouterProcess() as process:
        yield process


@pytest.fixture
def stranger(router):
    with router.bus():  # The router is up.
        config = zenoh.Config()
        config.insert_json5("mode", json.dumps("client"))
        config.insert_json5("connect/endpoints", json.dumps([f"tcp/127.0.0.1:{router.port}"]))
        config.insert_json5("scouting/multicast/enabled", "false")
        with zenoh.open(config) as session:
            yield session


@pytest.fixture
def bus(router):
    with router.bus() as bus:
        yield bus


def replies(session, key, payload):
    """What is answered to a question without any limit of ours."""
    return list(session.get(key, payload=payload, timeout=5))


def test_a_put_beyond_the_limit_is_counted_and_not_copied(stranger, bus):
    heard = []
    subscription = bus.subscribe(KEY, lambda _key, data: heard.append(len(data)))
    stranger.put(KEY, bytes(MAX_BYTES + 1), congestion_control=zenoh.CongestionControl.BLOCK)
    until(lambda: subscription.dropped == 1)
    stranger.put(KEY, bytes(10), congestion_control=zenoh.CongestionControl.BLOCK)
    until(lambda: heard == [10])


def test_a_question_beyond_the_limit_is_refused(stranger, bus):
    bus.serve("a", lambda _key, _data: b"ok")
    until(lambda: answered(bus))
    (reply,) = replies(stranger, "a", bytes(MAX_BYTES + 1))
    assert str(MAX_BYTES) in reply.err.payload.to_string()
    assert answered(bus)


def test_a_message_of_many_megabytes_reaches_nobody_and_harms_nobody(router, stranger, bus):
    heard = []
    bus.subscribe(any_robot("lab", "decision"), lambda _key, data: heard.append(len(data)))
    bus.serve("a", lambda _key, _data: b"ok")
    until(lambda: answered(bus))
    stranger.put(KEY, bytes(5 * MAX_BYTES), congestion_control=zenoh.CongestionControl.BLOCK)
    with router.bus() as other:
        until(lambda: answered(other))
        until(lambda: other.watched(KEY))
        other.put(KEY, bytes(10))
        until(lambda: heard)
    assert heard == [10]
    assert bus.connected


@pytest.mark.parametrize("stamp", [None, b"", b"short", bytes(16), b"\xff" * 16, bytes(10_000)])
def test_a_false_stamp_does_not_keep_a_follower_from_the_truth(stranger, bus, stamp):
    values = []
    bus.follow(any_service("lab", "learner", "policy"), lambda _key, data: values.append(data))
    until(lambda: stranger.put(POLICY, b"false", attachment=stamp) or values)
    bus.latest(POLICY, b"true")
    until(lambda: b"true" in values)


@pytest.mark.parametrize("known", [b"x", bytes(17), b"\xff" * 100_000, bytes(MAX_BYTES + 1)])
def test_a_question_for_the_latest_value_may_carry_rubbish(stranger, bus, known):
    bus.latest(POLICY, b"1.0")
    until(lambda: replies(stranger, POLICY, b""))
    replies(stranger, POLICY, known)
    (reply,) = replies(stranger, POLICY, b"")
    assert reply.ok.payload.to_bytes() == b"1.0"


@pytest.mark.parametrize("key", ["a/x$*", "hld/v1/lab/actor/r$*/decision", "**"])
def test_a_question_with_any_wildcard_gets_some_answer(stranger, bus, key):
    seen = []
    bus.serve("a/*", lambda key, _data: seen.append(key) or b"ok")
    bus.serve(any_robot("lab", "decision"), lambda key, _data: seen.append(key) or b"ok")
    until(lambda: replies(stranger, key, b""))
    until(lambda: seen)


def test_a_deletion_is_no_message(stranger, bus):
    heard = []
    subscription = bus.subscribe(KEY, lambda _key, data: heard.append(data))
    bus.follow(KEY, lambda _key, data: heard.append(data))
    until(lambda: stranger.delete(KEY) or subscription.dropped)
    assert heard == []
