"""The courier: in order, until it is answered, never lost."""

from itertools import pairwise

import pytest

from shared.clock import ManualClock, SystemClock
from shared.errors import RefusedError
from shared.wire.delivery import Courier
from shared.wire.memory import MemoryBus, MemoryRouter
from shared.wire.outbox import Outbox
from tests.integration.wire.processes import until

KEY = "hld/v1/lab/actor/r-1/decision"


class Receiver:
    """Takes parcels like the learner; `say` decides what each is answered."""

    def __init__(self, bus):
        self.heard = []
        self.say = lambda _data: b"ok"
        bus.serve(KEY, self.answer)

    def answer(self, _key, data):
        self.heard.append(data)
        return self.say(data)


@pytest.fixture
def router():
    return MemoryRouter()


@pytest.fixture
def bus(router):
    with MemoryBus(router) as bus:
        yield bus


@pytest.fixture
def outbox(tmp_path):
    with Outbox(tmp_path / "outbox.sqlite") as outbox:
        yield outbox


def fill(outbox, count):
    for number in range(count):
        outbox.add(f"p-{number}", KEY, str(number).encode())
    return [str(number).encode() for number in range(count)]


def test_everything_is_delivered_once_and_in_order(bus, outbox):
    receiver = Receiver(bus)
    sent = fill(outbox, 150)
    with Courier(bus, outbox, SystemClock()) as courier:
        assert courier.drained(10)
        assert receiver.heard == sent
        assert courier.delivered == 150


def test_what_is_added_later_leaves_when_the_courier_is_woken(bus, outbox):
    receiver = Receiver(bus)
    with Courier(bus, outbox, SystemClock()) as courier:
        assert courier.drained(10)
        outbox.add("late", KEY, b"late")
        courier.wake()
        until(lambda: receiver.heard == [b"late"])


def test_without_an_answer_it_tries_again_later_and_later(bus, outbox):
    clock, watching = RushingClock(step_s=0.2), AskedBus(bus)
    watching.clock = clock
    fill(outbox, 2)
    with Courier(watching, outbox, clock):
        until(lambda: len(watching.asked) > 5)
        receiver = Receiver(bus)
        until(lambda: receiver.heard == [b"0", b"1"])
    times_s, payloads = zip(*watching.asked[:6], strict=True)
    waits_s = [later - earlier for earlier, later in pairwise(times_s)]
    assert waits_s == pytest.approx([0.2, 0.4, 0.8, 1.6, 2.0], abs=0.41)
    assert waits_s == sorted(waits_s)
    assert set(payloads) == {b"0"}


class AskedBus:
    """A bus that writes down when it is asked what."""

    def __init__(self, bus):
        self._bus, self.asked, self.clock = bus, [], None

    def ask(self, key, payload, **options):
        self.asked.append((self.clock.now_ns() / 1e9, payload))
        return self._bus.ask(key, payload, **options)


class RushingClock(ManualClock):
    """Every look at this clock is so much later."""

    def __init__(self, step_s):
        super().__init__()
        self._step_ns = int(step_s * 1e9)

    def monotonic_ns(self):
        self.advance(self._step_ns)
        return super().monotonic_ns()


def test_a_refused_parcel_is_kept_aside_and_the_next_one_leaves(bus, outbox):
    receiver = Receiver(bus)

    def say(data):
        if data == b"1":
            raise RefusedError("no such episode")
        return b"ok"

    receiver.say = say
    sent = fill(outbox, 3)
    with Courier(bus, outbox, SystemClock()) as courier:
        assert courier.drained(10)
        assert receiver.heard == sent
        assert (courier.delivered, courier.refused) == (2, 1)
    (refusal,) = outbox.refused()
    assert (refusal.parcel.id, refusal.parcel.payload, refusal.reason) == (
        "p-1",
        b"1",
        "no such episode",
    )


def test_an_internal_error_of_the_receiver_is_tried_again(bus, outbox):
    receiver = Receiver(bus)

    def say(_data):
        if len(receiver.heard) < 3:
            raise OSError("disk full")
        return b"ok"

    receiver.say = say
    fill(outbox, 1)
    with Courier(bus, outbox, SystemClock()) as courier:
        assert courier.drained(10)
    assert receiver.heard == [b"0"] * 3
    assert outbox.refused() == []


@pytest.mark.parametrize("answer", [b"", b"OK", b"later"])
def test_a_record_that_always_breaks_the_receiver_is_kept_aside_in_the_end(bus, outbox, answer):
    receiver = Receiver(bus)
    receiver.say = lambda data: answer if data == b"0" else b"ok"
    fill(outbox, 2)
    clock = RushingClock(step_s=10)
    with Courier(bus, outbox, clock) as courier:
        until(lambda: courier.delivered == 1, 30)
    assert receiver.heard == [b"0"] * 30 + [b"1"]
    assert [refusal.reason for refusal in outbox.refused()] == ["internal error"]


def test_an_outage_of_the_router_loses_and_reorders_nothing(router, bus, outbox):
    receiver = Receiver(bus)
    sent = fill(outbox, 50)
    router.stop()
    with Courier(bus, outbox, SystemClock()) as courier:
        assert not courier.drained(0.2)
        router.start()
        assert courier.drained(10)
    assert receiver.heard == sent


def test_what_was_not_delivered_waits_for_the_next_courier(bus, outbox):
    sent = fill(outbox, 3)
    with Courier(bus, outbox, SystemClock()):
        pass
    assert len(outbox) == 3
    receiver = Receiver(bus)
    with Courier(bus, outbox, SystemClock()) as courier:
        assert courier.drained(10)
    assert receiver.heard == sent


def test_an_outbox_that_fails_for_a_while_stops_nobody_for_ever(bus, outbox):
    class Failing:
        """The first two looks at it fail."""

        def __init__(self):
            self.looks = 0

        def pending(self, limit=100):
            self.looks += 1
            if self.looks < 3:
                raise OSError("disk full")
            return outbox.pending(limit)

        def done(self, id):
            outbox.done(id)

        def refuse(self, id, reason):
            outbox.refuse(id, reason)

        def __len__(self):
            return len(outbox)

    receiver = Receiver(bus)
    fill(outbox, 1)
    with Courier(bus, Failing(), SystemClock()) as courier:
        assert courier.drained(10)
    assert receiver.heard == [b"0"]
