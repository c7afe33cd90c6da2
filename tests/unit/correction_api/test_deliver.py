"""A correction is repeated until its receipt, in order, and given up when it is old."""

import asyncio
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from services.correction_api.config import DeliverySettings
from services.correction_api.deliver import Messenger
from services.correction_api.store.log import Closed, Entry, Status
from services.correction_api.store.store import Store
from shared.clock import ManualClock
from shared.errors import RefusedError
from shared.messages.correction import Correction
from shared.wire.codec import decode, encode
from shared.wire.keys import any_robot
from shared.wire.memory import MemoryBus, MemoryRouter
from tests.unit.correction_api.store import correction, opened_store, receipt

WITHIN_S = 60.0  # Far more than is needed, for machines that are busy.
QUICK = DeliverySettings(ask_s=0.2, retry_s=0.01, retry_max_s=0.02, expire_s=60)


@contextmanager
def _robots(router: MemoryRouter, answer: Callable[[Correction], bytes]) -> Iterator[None]:
    """Serve the corrections of all robots."""
    with MemoryBus(router) as bus:
        bus.serve(any_robot("lab", "correction"), lambda _, data: answer(decode(Correction, data)))
        yield


async def _deliver(
    store: Store, router: MemoryRouter, names: list[str], clock: ManualClock | None = None
) -> list[Entry]:
    """Say all of `names` to the robots that their ids begin with, and wait until all is closed."""
    closed: list[Entry] = []
    done = asyncio.Event()

    def close(entry: Closed) -> None:
        closed.append(entry.entry)
        if len(closed) == len(names):
            done.set()

    with MemoryBus(router) as bus:
        messenger = Messenger(bus, "lab", store.log, clock or ManualClock(), QUICK, close)
        for name in names:
            said = correction(name, robot=name.rpartition("-")[0])
            messenger.send([store.log.append(said, "d").result()])
        await asyncio.wait_for(done.wait(), WITHIN_S)
        await messenger.close()
    return closed


def test_each_robot_hears_in_the_order_in_which_it_was_said(tmp_path: Path) -> None:
    heard: list[str] = []

    def answer(said: Correction) -> bytes:
        heard.append(said.id)
        if heard.count(said.id) < 3:
            raise RefusedError("busy")
        return encode(receipt(said.id, robot=said.robot))

    names = [f"robot-{robot}-{number}" for number in range(4) for robot in (1, 2)]
    router = MemoryRouter()
    with opened_store(tmp_path / "a.sqlite") as store, _robots(router, answer):
        closed = asyncio.run(_deliver(store, router, names))
    assert {entry.status for entry in closed} == {Status.IN_FORCE}
    for robot in ("robot-1", "robot-2"):
        first_heard = list(dict.fromkeys(name for name in heard if name.startswith(robot)))
        assert first_heard == [name for name in names if name.startswith(robot)]


def test_a_robot_that_is_away_holds_up_nobody_else(tmp_path: Path) -> None:
    router = MemoryRouter()

    def answer(said: Correction) -> bytes:
        if said.robot == "robot-1":
            raise RefusedError("the control loop of this robot stands still")
        return encode(receipt(said.id, robot=said.robot, reason="over"))

    async def test(store: Store) -> Entry:
        first: asyncio.Future[Closed] = asyncio.get_running_loop().create_future()
        with MemoryBus(router) as bus:
            messenger = Messenger(bus, "lab", store.log, ManualClock(), QUICK, first.set_result)
            for name in ("robot-1-0", "robot-2-0"):
                said = correction(name, robot=name[:7])
                messenger.send([store.log.append(said, "d").result()])
            entry = (await asyncio.wait_for(first, WITHIN_S)).entry
            assert len(messenger) == 1
            await messenger.close()
        return entry

    with opened_store(tmp_path / "a.sqlite") as store, _robots(router, answer):
        entry = asyncio.run(test(store))
        assert (entry.correction.id, entry.status, entry.reason) == (
            "robot-2-0",
            Status.REFUSED,
            "over",
        )
        assert [left.correction.id for left in store.log.pending()] == ["robot-1-0"]


def test_a_receipt_for_something_else_is_no_receipt(tmp_path: Path) -> None:
    answers = ["c-other", "robot-1-0"]
    router = MemoryRouter()

    def answer(said: Correction) -> bytes:
        return encode(receipt(answers.pop(0), robot=said.robot))

    with opened_store(tmp_path / "a.sqlite") as store, _robots(router, answer):
        closed = asyncio.run(_deliver(store, router, ["robot-1-0"]))
    assert closed[0].receipt is not None
    assert closed[0].receipt.correction == "robot-1-0"
    assert answers == []


def test_what_nobody_answered_is_given_up_and_never_obeyed_later(tmp_path: Path) -> None:
    heard: list[str] = []

    def answer(said: Correction) -> bytes:
        heard.append(said.id)
        return encode(receipt(said.id, robot=said.robot))

    late = ManualClock(start_ns=2 * 60 * 10**9)  # The correction was said at 1 ns.
    router = MemoryRouter()
    with opened_store(tmp_path / "a.sqlite") as store, _robots(router, answer):
        closed = asyncio.run(_deliver(store, router, ["robot-1-0"], late))
    assert (closed[0].status, closed[0].receipt) == (Status.EXPIRED, None)
    assert closed[0].reason == "the robot gave no receipt within 60 s"
    assert heard == []
