"""What every bus promises of who is there, who listens, and of its own end."""

import threading

import pytest

from shared.errors import NoAnswerError
from shared.wire.keys import any_robot, robot_key, service_key
from tests.contract.buses import heard_by, in_touch
from tests.integration.wire.processes import until


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
