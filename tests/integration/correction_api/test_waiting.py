"""What the pages say while there is nothing to see yet, and of when something was."""

from typing import Any

import httpx
import pytest
from playwright.sync_api import Browser, Route, expect

from shared.messages.heartbeat import LearnerState
from tests.integration.correction_api.browsing import opened
from tests.integration.correction_api.fakes import FakeLearner, FakeRobot
from tests.integration.correction_api.visiting import visited

LATER_MS = 20_000  # By then each page has asked again.

MIDNIGHT = """
async () => {
  const { clock } = await import("./words.js");
  const { when } = await import("./shell.js");
  const ms = Date.UTC(2026, 0, 31, 0, 5, 7);
  return [clock(ms), when(ms * 1e6)];
}
"""


def test_where_no_picture_came_yet_the_page_says_why(
    browser: Browser, api: httpx.Client, robot: FakeRobot, learner: FakeLearner
) -> None:
    robot.episode = None
    with opened(browser, api) as page:
        blank = page.locator(".blank")
        between = "robot-1 is between two episodes: its picture comes with the next one"
        expect(blank).to_have_text(f"{between}.")
        learner.beat(LearnerState.TRAINING)
        expect(blank).to_have_text(
            f"{between}. It may wait for the version that the learner makes."
        )
        expect(blank).to_be_visible()
        robot.episode = "robot-1-e2"
        expect(page.locator(".pictures canvas.angle.drawn")).to_be_visible()
        expect(blank).to_be_hidden()


PROXY = {"status": 502, "content_type": "text/html", "body": "<h1>Bad gateway</h1>"}


@pytest.mark.parametrize("path", ["episodes.html", "progress.html", "docs.html"])
@pytest.mark.parametrize("answer", [{}, PROXY], ids=["gone", "behind a proxy"])
def test_a_service_that_cannot_be_reached_is_told_in_words_and_the_page_comes_back(
    browser: Browser, api: httpx.Client, path: str, answer: dict[str, Any]
) -> None:
    def away(route: Route) -> None:
        route.fulfill(**answer) if answer else route.abort()

    with visited(browser, str(api.base_url.join(path)), outage=True) as page:
        page.route("**/api/v1/**", away)
        page.clock.install()
        page.reload()
        notice = page.locator(".notice", has_text="the service cannot be reached")
        expect(notice).to_have_text("the service cannot be reached")
        page.unroute("**/api/v1/**")
        page.clock.fast_forward(LATER_MS)
        expect(notice).to_have_count(0)


def test_the_hours_of_a_day_are_told_alike_everywhere_and_begin_at_zero(
    browser: Browser, api: httpx.Client
) -> None:
    american = {"locale": "en-US", "timezone_id": "UTC"}
    with opened(browser, api, path="docs.html", **american) as page:
        assert page.evaluate(MIDNIGHT) == ["00:05:07", "Jan 31, 2026, 00:05"]
