"""One robot, one learner and one API on a bus within the process."""

from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.fakes import FakeLearner, FakeRobot
from tests.integration.correction_api.running import eventually, running


@pytest.fixture
def router() -> MemoryRouter:
    """What the buses of a test share."""
    return MemoryRouter()


@pytest.fixture
def robot(router: MemoryRouter) -> Iterator[FakeRobot]:
    """robot-1, at work."""
    with MemoryBus(router) as bus:
        robot = FakeRobot(bus)
        yield robot
        robot.close()


@pytest.fixture
def learner(router: MemoryRouter) -> Iterator[FakeLearner]:
    """A learner that takes everything."""
    with MemoryBus(router) as bus:
        learner = FakeLearner(bus)
        yield learner
        learner.close()


@pytest.fixture
def api(
    router: MemoryRouter, robot: FakeRobot, learner: FakeLearner, tmp_path: Path
) -> Iterator[httpx.Client]:
    """A client of an API that has heard of robot-1."""
    del robot, learner  # They only have to be there.
    with MemoryBus(router) as bus, running(bus, tmp_path) as client:
        eventually(lambda: client.get("api/v1/robots").json()["robots"])
        yield client


@pytest.fixture(scope="module")
def standing_api(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    """Like `api`, one for all tests of a file that leave no trace in it."""
    router = MemoryRouter()
    with MemoryBus(router) as bus, MemoryBus(router) as robots:
        robot = FakeRobot(robots)
        with running(bus, tmp_path_factory.mktemp("api")) as client:
            eventually(lambda: client.get("api/v1/robots").json()["robots"])
            yield client
        robot.close()
