"""Esc on the page stops a real robot whatever its episode does meanwhile: it is about none."""

from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, Route, expect

from tests.integration.correction_api.browsing import line
from tests.integration.correction_api.processes import Cell
from tests.integration.correction_api.running import eventually
from tests.integration.correction_api.test_access import at_work
from tests.integration.correction_api.visiting import visited

REST_S = 6.0


@pytest.fixture(scope="module")
def brief(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cell]:
    """One robot whose episodes take two seconds, with six seconds between them."""
    actor = {"rollout__max_steps": 100, "rest_s": REST_S}
    with Cell(tmp_path_factory.mktemp("brief"), robots=1, actor=actor) as cell:
        yield cell


@pytest.fixture
def page(browser: Browser, brief: Cell) -> Iterator[Page]:
    with visited(browser, brief.url) as page:
        at_work(page)
        yield page


def robot(cell: Cell) -> dict[str, Any]:
    return dict(cell.http.get("api/v1/robots/robot-1").json())


def stands_still(cell: Cell) -> bool:
    """In its episode, and by no step further some heartbeats after the one that says so."""

    def paused() -> dict[str, Any] | None:
        now = robot(cell)
        return now if now["episode"] and now["state"] == "paused" else None

    first = eventually(paused, within_s=3 * REST_S)
    ages = set[float]()
    eventually(lambda: ages.add(robot(cell)["age_s"]) or len(ages) > 10)
    now = robot(cell)
    return (now["state"], now["step"]) == ("paused", first["step"])


def carry_on(page: Page) -> None:
    expect(page.locator(".stopped")).to_be_visible()  # Else it is told that nothing is frozen.
    page.keyboard.press("c")
    expect(line(page)).to_contain_text("carry on, robot-1: heard at step")


def test_a_stop_between_two_episodes_holds_when_the_next_one_begins(
    page: Page, brief: Cell
) -> None:
    eventually(lambda: robot(brief)["episode"], within_s=60)
    eventually(lambda: robot(brief)["episode"] is None, within_s=60)  # All of the pause is left.
    page.keyboard.press("Escape")
    expect(line(page)).to_have_text("freeze, robot-1: in force since step 0")
    assert stands_still(brief)
    carry_on(page)


def test_a_stop_that_was_on_its_way_when_the_episode_changed_holds_in_the_next_one(
    page: Page, brief: Cell
) -> None:
    said_in = eventually(lambda: robot(brief)["episode"], within_s=60)

    def late(route: Route) -> None:
        eventually(lambda: robot(brief)["episode"] not in (None, said_in), within_s=60)
        route.continue_()

    page.route("**/api/v1/pause", late)
    page.keyboard.press("Escape")
    expect(line(page)).to_contain_text("freeze, robot-1: in force since step")
    page.unroute("**/api/v1/pause")
    assert stands_still(brief)
    carry_on(page)
