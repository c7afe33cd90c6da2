"""What waits for a page is bounded, and the newest wins."""

import asyncio
from collections import Counter

from services.correction_api.bell import Bell, wait
from services.correction_api.live import CAPACITY, WINDOW, Client, Live, Slot, View


def _client(dropped: Counter[str]) -> Client:
    return Client(Bell(asyncio.get_running_loop()), lambda kind: dropped.update([kind]))


def test_the_newest_picture_takes_the_place_of_one_that_waits() -> None:
    async def test() -> None:
        dropped = Counter[str]()
        client = _client(dropped)
        client.offer(Slot("frame", "robot-1", "angle"), lambda: b"old")
        client.offer(Slot("frame", "robot-2", "angle"), lambda: b"other")
        client.offer(Slot("frame", "robot-1", "angle"), lambda: b"new")
        assert [client.take(), client.take(), client.take()] == [b"new", b"other", None]
        assert dropped == {"frame": 1}

    asyncio.run(test())


def test_a_page_that_never_reads_costs_a_bounded_queue() -> None:
    async def test() -> None:
        dropped = Counter[str]()
        client = _client(dropped)
        for number in range(3 * CAPACITY):
            client.offer(Slot("correction", f"c-{number}"), lambda number=number: str(number))
        assert len(client) == CAPACITY
        assert dropped == {"correction": 2 * CAPACITY}
        assert client.take() == str(2 * CAPACITY)

    asyncio.run(test())


def test_a_page_that_tells_what_it_took_in_gets_no_more_than_it_can_show() -> None:
    async def test() -> None:
        client = _client(Counter())
        client.acknowledge(0)
        for number in range(WINDOW + 5):
            client.offer(Slot("correction", f"c-{number}"), lambda: "said")
        client.offer(Slot("robot", "robot-1"), lambda: "old")
        taken = 0
        while client.take():
            taken += 1
        assert taken == WINDOW
        client.offer(Slot("robot", "robot-1"), lambda: "new")
        client.acknowledge(WINDOW)
        assert [client.take() for _ in range(7)] == ["said"] * 5 + ["new", None]

    asyncio.run(test())


def test_a_state_is_put_into_words_when_it_is_sent() -> None:
    async def test() -> None:
        client, state = _client(Counter()), {"step": 1}
        client.offer(Slot("robot", "robot-1"), lambda: str(state["step"]))
        state["step"] = 2
        assert client.take() == "2"

    asyncio.run(test())


def test_pictures_go_only_to_pages_that_look() -> None:
    async def test() -> None:
        live, wanted = Live(), list[frozenset[View]]()
        live.on_look(wanted.append)
        looking, other = _client(Counter()), _client(Counter())
        live.join(looking)
        live.join(other)
        view = View("robot-1", "top")
        live.look(looking, [view])
        live.show(view, b"jpeg")
        assert (len(looking), len(other)) == (1, 0)
        live.leave(looking)
        assert wanted == [frozenset({view}), frozenset()]

    asyncio.run(test())


def test_a_bell_wakes_whoever_looked_before_it_rang() -> None:
    async def test() -> None:
        bell = Bell(asyncio.get_running_loop())
        rung = bell.event
        await asyncio.to_thread(bell.ring)
        assert await wait(rung, 5)
        assert not await wait(bell.event, 0.01)
        bell.silence()
        assert await wait(bell.event, 5)

    asyncio.run(test())
