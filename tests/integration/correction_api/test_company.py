"""Two people without tokens before one robot: whose name each sees, and who lifted whose freeze."""

import httpx
from playwright.sync_api import Browser, Page, expect

from tests.integration.correction_api.browsing import line, opened
from tests.integration.correction_api.fakes import FakeRobot


def call_oneself(page: Page, name: str) -> None:
    page.locator("input[name=author]").fill(name)


def test_each_sees_the_others_name_and_nobody_themselves(
    browser: Browser, api: httpx.Client, robot: FakeRobot
) -> None:
    robot.decide()
    with opened(browser, api) as mine, opened(browser, api) as other:
        call_oneself(mine, "Ada")
        call_oneself(other, "Bert")
        expect(mine.locator(".focus").get_by_text("bert is here, too")).to_be_visible()
        expect(other.locator(".focus").get_by_text("ada is here, too")).to_be_visible()
        expect(mine.get_by_text("is here, too")).to_have_count(1)
        expect(other.get_by_text("is here, too")).to_have_count(1)


def test_whoever_froze_a_robot_is_told_who_let_it_carry_on(
    browser: Browser, api: httpx.Client, robot: FakeRobot
) -> None:
    robot.decide()
    with opened(browser, api) as mine, opened(browser, api) as other:
        call_oneself(mine, "Ada")
        call_oneself(other, "Bert")
        mine.locator("h2").first.click()
        mine.keyboard.press("Escape")
        expect(line(mine)).to_contain_text("freeze, robot-1: in force since step")
        expect(other.locator(".stopped")).to_be_visible()
        other.locator("h2").first.click()
        other.keyboard.press("c")
        expect(line(mine)).to_have_text("bert let robot-1 carry on, which you froze")
        expect(line(other)).to_contain_text("carry on, robot-1: heard at step")
