"""What every bus promises of values of which only the latest counts."""

from shared.wire.keys import any_service, service_key
from tests.contract.buses import answered, heard_by, in_touch
from tests.integration.wire.processes import until


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
