"""Two buses on one router, for each implementation of the protocol."""

import itertools
from collections.abc import Callable, Iterator

import pytest

from shared.wire.bus import Bus
from shared.wire.keys import robot_key
from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.wire.processes import RouterProcess

Buses = Callable[[], Bus]

_fleets = itertools.count()


@pytest.fixture(scope="session")
def zenoh_router() -> Iterator[RouterProcess]:
    with RouterProcess() as process:
        yield process


@pytest.fixture(params=["memory", "zenoh"])
def new_bus(request: pytest.FixtureRequest) -> Iterator[Buses]:
    """Makes buses that share a router; they are closed when the test ends."""
    made: list[Bus] = []
    if request.param == "memory":
        shared = MemoryRouter()
        make: Buses = lambda: MemoryBus(shared)  # noqa: E731
    else:
        make = request.getfixturevalue("zenoh_router").bus

    def new() -> Bus:
        made.append(make())
        return made[-1]

    yield new
    for bus in made:
        bus.close()


@pytest.fixture
def bus(new_bus: Buses) -> Bus:
    return new_bus()


@pytest.fixture
def other(new_bus: Buses) -> Bus:
    return new_bus()


@pytest.fixture
def fleet() -> str:
    """A place of its own on the bus for each test, since those of Zenoh share one router."""
    return f"fleet-{next(_fleets)}"


@pytest.fixture
def key(fleet: str) -> str:
    return robot_key(fleet, "r-1", "decision")
