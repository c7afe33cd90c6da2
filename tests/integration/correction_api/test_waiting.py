"""What the pages say while there is nothing to see yet, and of when something was."""

import httpx
from playwright.sync_api import Browser, expect

from shared.messages.heartbeat import LearnerState
from tests.integration.correction_api.browsing import opened
from tests.integration.correction_api.fakes import FakeLearner, FakeRobot

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


def test_the_hours_of_a_day_are_told_alike_everywhere_and_begin_at_zero(
    browser: Browser, api: httpx.Client
) -> None:
    american = {"locale": "en-US", "timezone_id": "UTC"}
    with opened(browser, api, path="docs.html", **american) as page:
        assert page.evaluate(MIDNIGHT) == ["00:05:07", "Jan 31, 2026, 00:05"]
