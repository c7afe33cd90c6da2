"""One robot, one learner and one API on a bus within the process."""

from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Browser, Page, expect

from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.browsing import launched, opened
from tests.integration.correction_api.crowded import crowded
from tests.integration.correction_api.fakes import COMMANDS, FakeLearner, FakeRobot
from tests.integration.correction_api.keeper import kept
from tests.integration.correction_api.processes import Cell
from tests.integration.correction_api.running import eventually, running


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """One browser for the tests of a file."""
    with launched() as browser:
        yield browser


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
def other(router: MemoryRouter, robot: FakeRobot) -> Iterator[FakeRobot]:
    """robot-2, beside robot-1."""
    del robot  # It only has to be there first.
    with MemoryBus(router) as bus:
        other = FakeRobot(bus, "robot-2")
        yield other
        other.close()


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


@pytest.fixture
def page(browser: Browser, api: httpx.Client, robot: FakeRobot) -> Iterator[Page]:
    """The page, on which the proposals of robot-1 are seen."""
    robot.decide()
    with opened(browser, api) as page:
        expect(page.locator(".proposal")).to_have_count(len(COMMANDS))
        yield page


@pytest.fixture(scope="module")
def crowd(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    """An API that has heard of three robots with much to say, for all tests of a file."""
    with crowded(tmp_path_factory.mktemp("api")) as client:
        yield client


@pytest.fixture(scope="module")
def standing_api(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    """Like `api`, one for all tests of a file that leave no trace in it."""
    with kept(tmp_path_factory.mktemp("api")) as (client, _):
        yield client


@pytest.fixture(scope="module")
def cell(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cell]:
    """Two real robots in a process, which work for all tests of a file, and no longer."""
    with Cell(tmp_path_factory.mktemp("cell")) as cell:
        yield cell
