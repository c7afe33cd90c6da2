"""What is in the outbox is there until it is done, whatever dies."""

import signal
import subprocess
import sys
import threading

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shared.wire.outbox import Outbox, Parcel
from tests.integration.wire.processes import ROOT, until


@pytest.fixture
def path(tmp_path):
    return tmp_path / "deep" / "outbox.sqlite"


@pytest.fixture
def outbox(path):
    with Outbox(path) as outbox:
        yield outbox


def ids(outbox):
    return [parcel.id for parcel in outbox.pending(1000)]


def test_parcels_wait_in_the_order_in_which_they_were_added(outbox):
    for id in ("b", "a", "c"):
        outbox.add(id, f"k/{id}", id.encode())
    assert ids(outbox) == ["b", "a", "c"]
    assert outbox.pending(1) == [Parcel("b", "k/b", b"b", 1)]
    assert len(outbox) == 3


def test_adding_again_changes_nothing(outbox):
    outbox.add("a", "k", b"first")
    outbox.add("b", "k", b"")
    outbox.add("a", "other", b"second")
    assert [(p.id, p.key, p.payload) for p in outbox.pending()] == [
        ("a", "k", b"first"),
        ("b", "k", b""),
    ]


def test_what_is_done_is_gone_and_may_be_done_again(outbox):
    outbox.add("a", "k", b"")
    outbox.done("a")
    outbox.done("a")
    outbox.done("never-there")
    assert len(outbox) == 0


def test_what_was_refused_is_kept_aside_with_its_reason(outbox):
    for id in ("a", "b"):
        outbox.add(id, "k", id.encode())
    outbox.refuse("a", "unknown episode")
    assert ids(outbox) == ["b"]
    assert [(r.parcel.id, r.parcel.payload, r.reason) for r in outbox.refused()] == [
        ("a", b"a", "unknown episode")
    ]


def test_a_refused_parcel_does_not_come_back_by_being_added_again(outbox):
    outbox.add("a", "k", b"")
    outbox.refuse("a", "no")
    outbox.add("a", "k", b"")
    assert len(outbox) == 0


def test_a_refused_parcel_goes_back_to_its_old_place(outbox):
    for id in ("a", "b"):
        outbox.add(id, "k", b"")
    outbox.refuse("a", "no")
    assert outbox.retry() == 1
    assert ids(outbox) == ["a", "b"]
    assert outbox.refused() == []
    assert outbox.retry() == 0


def test_everything_is_there_after_it_is_opened_again(path):
    with Outbox(path) as outbox:
        for id in ("a", "b", "c"):
            outbox.add(id, "k", b"")
        outbox.done("b")
        outbox.refuse("c", "no")
    with Outbox(path) as outbox:
        outbox.add("d", "k", b"")
        assert ids(outbox) == ["a", "d"]
        assert [refusal.parcel.id for refusal in outbox.refused()] == ["c"]


WRITER = """
import sys
from pathlib import Path
from shared.wire.outbox import Outbox
outbox = Outbox(Path(sys.argv[1]))
for number in range(100_000):
    outbox.add(f"p-{number}", "k", b"x" * 1000)
    print(number, flush=True)
"""


def test_what_was_added_survives_a_kill(path):
    writer = subprocess.Popen(
        [sys.executable, "-c", WRITER, str(path)], cwd=ROOT, stdout=subprocess.PIPE, text=True
    )
    with writer:
        added = [int(writer.stdout.readline()) for _ in range(20)]
        writer.send_signal(signal.SIGKILL)
        added += [int(line) for line in writer.stdout.read().split()]
    with Outbox(path) as outbox:
        assert ids(outbox)[: len(added)] == [f"p-{number}" for number in added]
        assert len(outbox) <= len(added) + 1


def test_many_threads_may_add_at_once(outbox):
    def fill(name):
        for number in range(20):
            outbox.add(f"{name}-{number:02}", "k", b"")

    threads = [threading.Thread(target=fill, args=(name,)) for name in "abcd"]
    for thread in threads:
        thread.start()
    until(lambda: len(outbox) == 80)
    for name in "abcd":
        mine = [id for id in ids(outbox) if id.startswith(name)]
        assert mine == sorted(mine)


actions = st.lists(
    st.tuples(st.sampled_from(["add", "done", "refuse", "retry"]), st.sampled_from("abcde")),
    max_size=30,
)


@settings(max_examples=25, deadline=None)  # Each one writes to the disk.
@given(actions)
def test_an_outbox_behaves_as_two_ordered_lists(tmp_path_factory, steps):
    waiting, aside, order = [], [], []
    with Outbox(tmp_path_factory.mktemp("o") / "o.sqlite") as outbox:
        for act, id in steps:
            if act == "add":
                outbox.add(id, "k", b"")
                if id not in waiting + aside:
                    waiting.append(id)
                    order.append(id)
            elif act == "done":
                outbox.done(id)
                waiting = [other for other in waiting if other != id]
            elif act == "refuse":
                outbox.refuse(id, "no")
                if id in waiting:
                    waiting.remove(id)
                    aside.append(id)
            else:
                outbox.retry()
                waiting, aside = waiting + aside, []
            last = {id: place for place, id in enumerate(order)}
            waiting.sort(key=last.__getitem__)
            assert ids(outbox) == waiting
            assert {refusal.parcel.id for refusal in outbox.refused()} == set(aside)
