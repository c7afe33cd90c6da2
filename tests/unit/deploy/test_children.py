"""The supervisor's children: real processes, small ones."""

import os
import signal
import time

import pytest

from deploy.children import ChildError, Family, sets
from deploy.ports import check_free, free_port
from shared.errors import HldError

DEADLINE_S = 60.0


def wait_for(look):
    deadline = time.monotonic() + DEADLINE_S
    while not look():
        assert time.monotonic() < deadline
        time.sleep(0.01)


@pytest.fixture
def family(tmp_path):
    family = Family(tmp_path)
    yield family
    family.end()


def test_a_child_that_dies_is_started_again(family):
    child = family.add("server", "http.server", "0")
    first = child.pid
    os.kill(first, signal.SIGKILL)
    wait_for(lambda: not child.running)
    wait_for(lambda: family.mind() or child.running)
    assert child.pid != first
    assert child.restarts == 1


def test_a_child_with_a_wrong_configuration_is_not_tried_again_but_shown(family):
    child = family.add("server", "http.server", "--no-such-option")
    wait_for(lambda: not child.running)
    with pytest.raises(ChildError, match="no-such-option"):
        family.mind()


def test_the_family_ends_in_reverse_and_says_whom_it_had_to_kill(family):
    family.add("server", "http.server", "0")
    family.add("other", "http.server", "0")
    assert family.end() == []
    assert not any(child.running for child in family.children)


def test_sets_turn_into_options_with_dots_and_json():
    assert sets(a__b=1, c=["x"]) == ["--set", "a.b=1", "--set", 'c=["x"]']


def test_a_taken_port_is_named_together_with_the_option_that_helps():
    import socket

    with socket.socket() as holder:
        holder.bind(("127.0.0.1", 0))
        holder.listen()
        with pytest.raises(HldError, match="--router-port"):
            check_free("the router", holder.getsockname()[1])
    check_free("the page", free_port())
