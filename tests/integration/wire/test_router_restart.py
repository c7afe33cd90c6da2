"""The router dies and comes back; what may not be lost is not lost."""

import hashlib
import os
import threading

import pytest

from shared.clock import SystemClock
from shared.errors import NoAnswerError
from shared.messages.policy import TensorRef
from shared.wire.bus import open_bus
from shared.wire.delivery import Courier
from shared.wire.keys import any_robot, any_service, robot_key, service_key
from shared.wire.outbox import Outbox
from shared.wire.tensors import CHUNK_BYTES, TensorFetcher, TensorPublisher
from tests.integration.wire.processes import RouterProcess, until

DECISION = robot_key("lab", "robot-1", "decision")
POLICY = service_key("lab", "learner", "l-1", "policy")
TENSOR = service_key("lab", "learner", "l-1", "tensor")


@pytest.fixture
def learner(router):
    with router.bus() as bus:
        yield bus


@pytest.fixture
def actor(router):
    with router.bus() as bus:
        yield bus


class Receiver:
    """Knows a record again by its id, as the learner's store does."""

    def __init__(self, bus):
        self.first, self.again = [], 0
        self._serving = bus.serve(any_robot("lab", "decision"), self._take)

    def _take(self, _key, data):
        if data in self.first:
            self.again += 1
        else:
            self.first.append(data)
        return b"ok"

    def close(self):
        self._serving.close()


def fill(outbox, start, count):
    for number in range(start, start + count):
        outbox.add(f"dec-{number:05}", DECISION, f"dec-{number:05}".encode() + bytes(2000))
    return [f"dec-{number:05}".encode() + bytes(2000) for number in range(start, start + count)]


def test_every_record_is_delivered_once_and_in_order_though_the_router_is_killed(
    router, actor, learner, tmp_path
):
    receiver = Receiver(learner)
    with (
        Outbox(tmp_path / "outbox.sqlite") as outbox,
        Courier(actor, outbox, SystemClock()) as courier,
    ):
        sent = []
        for turn in range(3):
            sent += fill(outbox, 100 * turn, 100)
            courier.wake()
            until(lambda turn=turn: len(receiver.first) > 100 * turn + 30, 20)
            router.kill()
            sent += fill(outbox, 100 * turn + 10_000, 5)
            until(lambda: not actor.connected)
            router.start()
            assert courier.drained(20)
        assert receiver.first == sent
        assert courier.delivered == len(sent) == 315
        assert outbox.refused() == []


def test_records_made_while_the_learner_is_away_reach_the_one_that_comes_after(
    router, actor, tmp_path
):
    with (
        Outbox(tmp_path / "outbox.sqlite") as outbox,
        Courier(actor, outbox, SystemClock()) as courier,
    ):
        with router.bus() as first_life:
            receiver = Receiver(first_life)
            early = fill(outbox, 0, 20)
            assert courier.drained(10)
            assert receiver.first == early
        late = fill(outbox, 20, 20)
        assert not courier.drained(0.3)
        with router.bus() as second_life:
            receiver = Receiver(second_life)
            assert courier.drained(10)
            assert receiver.first == late


def test_subscriptions_and_questions_work_again_after_a_restart(router, actor, learner):
    heard = []
    learner.subscribe(DECISION, lambda _key, data: heard.append(data))
    learner.serve(DECISION, lambda _key, _data: b"ok")
    until(lambda: actor.watched(DECISION))
    router.kill()
    until(lambda: not actor.connected and not learner.connected)
    actor.put(DECISION, b"lost")
    with pytest.raises(NoAnswerError):
        actor.ask(DECISION, timeout_s=1)
    router.start()
    until(lambda: actor.connected and learner.connected, 15)

    def through():
        actor.put(DECISION, b"again")
        return heard

    until(through)
    assert b"lost" not in heard
    assert actor.ask(DECISION, timeout_s=5) == b"ok"
    until(lambda: actor.watched(DECISION))


def followed_by(bus):
    values = []
    bus.follow(any_service("lab", "learner", "policy"), lambda _key, data: values.append(data))
    return values


def test_a_late_joiner_gets_the_latest_announcement_also_after_a_restart(router, learner):
    for version in (b"1.0", b"1.1"):
        learner.latest(POLICY, version)
    with router.bus() as late:
        values = followed_by(late)
        until(lambda: values[-1:] == [b"1.1"])
    router.kill()
    router.start()
    with router.bus() as later:
        values = followed_by(later)
        until(lambda: values == [b"1.1"], 15)


def test_an_announcement_made_while_the_router_is_away_comes_when_it_is_back(
    router, actor, learner
):
    values = followed_by(actor)
    learner.latest(POLICY, b"1.0")
    until(lambda: values == [b"1.0"])
    router.kill()
    until(lambda: not learner.connected)
    learner.latest(POLICY, b"1.1")
    router.start()
    until(lambda: values == [b"1.0", b"1.1"], 15)


def test_a_learner_that_restarts_is_followed_at_once_whatever_its_clock_says(router, actor):
    values = followed_by(actor)
    for life in (b"1.0", b"2.0"):
        with router.bus() as learner:
            learner.latest(POLICY, life)
            until(lambda life=life: values[-1:] == [life])
    assert values == [b"1.0", b"2.0"]


def test_tensors_lost_with_a_router_are_repaired(router, actor, learner):
    data = {
        hashlib.sha256(part).hexdigest(): part for part in map(os.urandom, [6 * CHUNK_BYTES, 100])
    }
    refs = [
        TensorRef(name="t", sha256=name, dtype="uint8", shape=(len(part),), size_bytes=len(part))
        for name, part in data.items()
    ]
    with TensorPublisher(learner, TENSOR) as publisher, TensorFetcher(actor, TENSOR, {}) as fetcher:
        until(lambda: learner.watched(f"{TENSOR}/{refs[0].sha256}/0"))
        pushing = threading.Thread(target=publisher.publish, args=(data,))
        pushing.start()
        router.kill()
        pushing.join(15)
        router.start()
        assert fetcher.fetch(refs, 20) == data


def test_a_service_may_start_before_the_router_and_ask_for_everything_at_once():
    router = RouterProcess()
    with open_bus(router.settings) as learner, open_bus(router.settings) as actor:
        heard, values, lives = [], followed_by(actor), []
        learner.subscribe(DECISION, lambda _key, data: heard.append(data))
        learner.serve(DECISION, lambda _key, _data: b"ok")
        learner.latest(POLICY, b"1.0")
        learner.alive("hld/v1/lab/learner/l-1/alive")
        actor.watch_alive("hld/v1/lab/*/*/alive", lambda _key, alive: lives.append(alive))
        assert not actor.connected
        assert not actor.watched(DECISION)
        actor.put(DECISION, b"lost")
        with pytest.raises(NoAnswerError, match=f"no router at tcp/127.0.0.1:{router.port}"):
            actor.ask(DECISION)
        with router:
            assert learner.joined(20)
            assert actor.joined(20)
            until(lambda: actor.watched(DECISION))
            actor.put(DECISION, b"1")
            until(lambda: heard == [b"1"] and values == [b"1.0"] and lives == [True])
            assert actor.ask(DECISION) == b"ok"


def test_a_bus_that_never_found_its_router_ends_at_once():
    bus = open_bus(RouterProcess().settings)
    bus.subscribe(DECISION, print)
    assert not bus.joined(0.05)
    ending = threading.Thread(target=bus.close)
    ending.start()
    ending.join(5)
    assert not ending.is_alive()
