"""The anatomy of a rollout among the figures: the newest episode that has ended, drawn."""

from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from shared.messages.episode import Outcome
from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.browsing import DESK, PHONE, opened
from tests.integration.correction_api.fakes import COMMANDS, FakeRobot
from tests.integration.correction_api.keeper import attempt, keeping
from tests.integration.correction_api.running import eventually, running
from tests.integration.correction_api.test_access import violations
from tests.integration.correction_api.visiting import visited

FIGURES = "figures.html"
LATER_MS = 20_000  # By then the page has asked again.


def panel(page: Page):  # type: ignore[no-untyped-def]
    return page.get_by_role("region", name="Anatomy of a rollout")


@pytest.mark.parametrize("size", [DESK, PHONE])
def test_the_newest_episode_that_has_ended_is_drawn_and_cannot_be_changed(
    browser: Browser,
    router: MemoryRouter,
    robot: FakeRobot,
    tmp_path: Path,
    size: tuple[int, int],
) -> None:
    with keeping(router, tmp_path), MemoryBus(router) as bus, running(bus, tmp_path) as api:
        eventually(lambda: api.get("api/v1/robots").json()["robots"])
        attempt(api, robot, decisions=3)
        with opened(browser, api, size, FIGURES) as page:
            page.clock.install()
            page.reload()
            picture = panel(page).get_by_role("img", name="3 decisions in")
            expect(picture).to_be_visible()
            attempt(api, robot, Outcome.TIMEOUT, decisions=6)
            page.clock.fast_forward(LATER_MS)
            picture = panel(page).get_by_role("img", name="6 decisions in")
            expect(picture.locator("rect.bar")).to_have_count(6)
            expect(picture.locator(".command").first).to_contain_text(COMMANDS[0])
            expect(panel(page).locator(".outcome")).to_have_text("timeout")
            row = panel(page).get_by_role("region", name="Table of reasons").locator("tbody tr")
            expect(row).to_have_count(1)
            expect(row.locator("td").first).to_have_text("6")
            expect(page.get_by_role("slider", name="Decision at the cursor")).to_have_count(0)
            box = picture.bounding_box()
            assert box
            page.mouse.move(box["x"] + 0.2 * box["width"], box["y"] + 50)
            page.mouse.down()
            page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + 50, steps=4)
            page.mouse.up()
            expect(picture.locator(".span, .cursor")).to_have_count(0)
            assert violations(page) == []
            assert page.evaluate("document.documentElement.scrollWidth") <= size[0]


@pytest.mark.parametrize("size", [DESK, PHONE])
def test_before_an_episode_has_ended_it_says_what_to_do(
    browser: Browser, router: MemoryRouter, tmp_path: Path, size: tuple[int, int]
) -> None:
    with MemoryBus(router) as bus, running(bus, tmp_path) as api:
        with opened(browser, api, size, FIGURES) as page:
            expect(panel(page).locator(".notice")).to_contain_text(
                "No episode has ended yet. Let robots work (hld up starts some)"
            )
            assert violations(page) == []


def test_while_the_learner_is_away_the_episode_is_told_and_what_is_missing(
    browser: Browser, router: MemoryRouter, robot: FakeRobot, tmp_path: Path
) -> None:
    with MemoryBus(router) as bus, running(bus, tmp_path) as api:
        eventually(lambda: api.get("api/v1/robots").json()["robots"])
        robot.decide()
        ended = robot.end()
        eventually(lambda: api.get("api/v1/episodes").json()["episodes"])
        with visited(browser, str(api.base_url.join(FIGURES))) as page:
            expect(panel(page).get_by_role("heading", level=3)).to_have_text(ended.prompt)
            expect(panel(page).locator(".notice")).to_contain_text("start it (hld learner)")
            link = panel(page).get_by_role("link", name="The newest episode")
            expect(link).to_have_attribute("href", f"episode.html?id={ended.id}")
            assert violations(page) == []
