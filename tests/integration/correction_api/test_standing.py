"""Where what was said stands: from when until when it held, and who is told that it doesn't."""

from typing import Any

import httpx
from playwright.sync_api import Page, expect

from tests.integration.correction_api.browsing import line, said
from tests.integration.correction_api.fakes import COMMANDS, FakeRobot
from tests.integration.correction_api.running import eventually

SAID = "api/v1/robots/robot-1/corrections"


def say(api: httpx.Client, **words: Any) -> int:
    """Say something by another way than the page; since when it is in force."""
    return api.post(SAID, json=words).raise_for_status().json()["receipt"]["step"]


def test_a_word_for_two_seconds_says_until_when_and_is_over_afterwards(
    page: Page, api: httpx.Client, robot: FakeRobot
) -> None:
    robot.deaf = True  # Its steps don't go on while one looks.
    step = say(api, kind="override", text=COMMANDS[1], author="person", hold_steps=60)
    row = said(page).first
    expect(row).to_contain_text(f"in force {step}–{step + 60}")
    expect(row).to_have_class("in-force")
    robot.deaf = False
    expect(row).to_have_class("over")


def test_a_freeze_is_over_when_the_robot_carries_on_and_a_word_with_its_episode(
    page: Page, robot: FakeRobot
) -> None:
    page.keyboard.press("2")
    expect(said(page).first).to_contain_text("in force since step")
    page.keyboard.press("Escape")
    expect(said(page).first).to_contain_text("freezein force since step")
    expect(page.locator(".stopped")).to_be_visible()
    page.keyboard.press("c")
    eventually(lambda: len(robot.receipts) == 3)
    begin, end = (robot.receipts[one.id].step for one in robot.heard[1:])
    expect(said(page).nth(1)).to_contain_text(f"freezein force {begin}–{end}")
    expect(said(page).nth(1)).to_have_class("over")
    expect(said(page).first).to_contain_text("carry onheard at step")
    robot.episode = None  # It rests between two.
    expect(said(page).last).to_contain_text("until its episode ended")
    expect(said(page).last).to_have_class("over")


def test_what_one_said_oneself_is_by_you_and_what_is_taken_back_is_named(
    page: Page, robot: FakeRobot
) -> None:
    page.keyboard.press("2")
    expect(line(page)).to_contain_text("in force since step")
    page.keyboard.press("3")
    expect(said(page).nth(1)).to_contain_text("replaced by you")
    page.keyboard.press("Control+z")
    expect(said(page)).to_have_count(3)
    expect(said(page).first).to_contain_text(f"taken back: “{COMMANDS[2]}”")
    expect(said(page).nth(1)).to_contain_text("lifted by you · taken back")
    assert [one.author for one in robot.heard] == ["person"] * 3


def test_a_freeze_of_a_robot_that_moved_by_no_step_says_where_it_stood(
    page: Page, api: httpx.Client, robot: FakeRobot
) -> None:
    robot.deaf = True  # Its steps stand still with it.
    step = say(api, kind="pause", author="bea")
    assert say(api, kind="resume", author="bea") == step
    expect(said(page).nth(1)).to_contain_text(f"freezestood still at step {step}")
    expect(said(page).nth(1)).to_have_class("over")
    for text in COMMANDS[1:3]:
        step = say(api, kind="override", text=text, author="bea")
    expect(said(page).nth(1)).to_contain_text(f"in force at step {step} only, replaced by bea")


def test_whoever_is_overruled_is_told_by_whom(
    page: Page, api: httpx.Client, robot: FakeRobot
) -> None:
    page.get_by_label("You are").fill("Zoë Müller")
    page.keyboard.press("Tab")
    page.locator(".proposal").nth(1).click()
    expect(line(page)).to_contain_text(f"“{COMMANDS[1]}”, robot-1: in force since step")
    expect(said(page).first.locator("small")).to_contain_text("you")
    begin = api.get("api/v1/corrections").json()["corrections"][0]
    assert begin["correction"]["author"] == "zoe-muller"
    eventually(lambda: robot.step > begin["receipt"]["step"])
    step = say(api, kind="override", text="wait", author="bob")
    told = f"in force {begin['receipt']['step']}–{step}, replaced by bob"
    expect(line(page)).to_have_text(f"“{COMMANDS[1]}”, robot-1: {told}")
    expect(line(page)).to_have_class("line bad")
    expect(said(page).nth(1)).to_contain_text(told)
    expect(said(page).nth(1)).to_have_class("over")


def test_two_robots_are_both_frozen_and_one_thing_is_no_plural(page: Page) -> None:
    halted = "(await import('./words.js')).halted"
    two = [{"robot": f"robot-{at}", "status": "in force"} for at in (1, 2)]
    assert page.evaluate(f"async robots => {halted}(robots)", two) == [
        "Both robots are frozen",
        "good",
    ]
    count = "async n => (await import('./words.js')).count(n, 'correction')"
    assert [page.evaluate(count, n) for n in (1, 2)] == ["1 correction", "2 corrections"]
