"""Keys of the live page: which ones can be had, what they take back, and what a reload keeps."""

import re

import httpx
import pytest
from playwright.sync_api import Page, expect

from shared.messages.correction import Kind
from shared.messages.goal import LanguageGoal
from shared.messages.heartbeat import RobotState
from tests.integration.correction_api.browsing import focused, line
from tests.integration.correction_api.fakes import COMMANDS, FakeRobot
from tests.integration.correction_api.running import eventually

REMAPPED = """
(kept) => localStorage.setItem("hld-keys", JSON.stringify(kept))
"""
PRESSED = """
(key) => {
  const event = new KeyboardEvent("keydown", { ...key, bubbles: true, cancelable: true });
  document.body.dispatchEvent(event);
  return event.defaultPrevented;
}
"""


def test_ctrl_z_after_a_freeze_lets_the_robot_go_on_and_then_takes_back_the_word_before(
    page: Page, robot: FakeRobot
) -> None:
    page.keyboard.press("2")
    expect(line(page)).to_contain_text("in force since step")
    page.keyboard.press("Escape")
    page.keyboard.press("Control+z")
    eventually(lambda: robot.kinds() == [Kind.OVERRIDE, Kind.PAUSE, Kind.RESUME])
    expect(line(page)).to_contain_text("freeze taken back, robot-1: heard at step")
    eventually(lambda: robot.state is RobotState.ACTING)
    page.keyboard.press("Control+z")
    eventually(lambda: robot.kinds()[3:] == [Kind.RETRACT])
    assert robot.heard[3].target == robot.heard[0].id
    expect(line(page)).to_contain_text(f"taken back “{COMMANDS[1]}”, robot-1: heard at step")


@pytest.mark.parametrize("at", [0, 1])
def test_ctrl_z_after_freeze_all_lets_the_robot_in_focus_go_on_and_no_other(
    page: Page, robot: FakeRobot, other: FakeRobot, at: int
) -> None:
    here, there = (robot, other)[at], (other, robot)[at]
    page.locator(f"[data-tile={here.name}]").click()
    expect(focused(page)).to_have_text(here.name)
    page.keyboard.press("Shift+Escape")
    page.keyboard.press("Control+z")
    eventually(lambda: here.kinds() == [Kind.PAUSE, Kind.RESUME])
    expect(line(page)).to_contain_text(f"freeze taken back, {here.name}: heard at step")
    eventually(lambda: here.state is RobotState.ACTING)
    page.keyboard.press("Control+z")
    expect(line(page)).to_have_text(
        f"{there.name} stays frozen, since you don't look at it: go to it to take that back"
    )
    assert there.kinds() == [Kind.PAUSE]
    page.locator(f"[data-tile={there.name}]").click()
    expect(focused(page)).to_have_text(there.name)
    page.keyboard.press("Control+z")
    eventually(lambda: there.kinds() == [Kind.PAUSE, Kind.RESUME])
    assert here.kinds() == [Kind.PAUSE, Kind.RESUME]


def test_a_freeze_that_somebody_else_means_as_well_is_not_taken_back(
    page: Page, robot: FakeRobot, api: httpx.Client
) -> None:
    page.keyboard.press("Escape")
    expect(line(page)).to_contain_text("in force since step")
    bea = {"kind": "pause", "author": "bea", "episode": robot.episode}
    api.post("api/v1/robots/robot-1/corrections", json=bea).raise_for_status()
    expect(page.locator(".said li")).to_have_count(2)
    page.keyboard.press("Control+z")
    expect(line(page)).to_contain_text("robot-1 stays frozen, since bea froze it, too")
    assert robot.state is RobotState.PAUSED


def test_that_was_right_says_which_command_was(page: Page) -> None:
    page.keyboard.press("y")
    expect(line(page)).to_contain_text(f"that was right: “{COMMANDS[0]}”, robot-1: heard")


def test_an_arrow_and_enter_say_the_command_that_is_chosen_and_enter_alone_says_nothing(
    page: Page, robot: FakeRobot
) -> None:
    page.keyboard.press("/")
    options = page.locator("[role=option]")
    expect(options.first).to_be_visible()
    expect(page.locator("[role=option][aria-selected=true]")).to_have_count(0)
    page.keyboard.press("Enter")
    page.keyboard.press("ArrowDown")
    chosen = page.locator("[role=option][aria-selected=true] q").inner_text()
    page.keyboard.press("Enter")
    eventually(lambda: robot.heard)
    assert [one.goal for one in robot.heard] == [LanguageGoal(text=chosen)]


def test_the_browser_does_nothing_by_the_key_that_freezes_all(page: Page) -> None:
    assert page.evaluate(PRESSED, {"key": "Escape", "shiftKey": True})
    expect(line(page)).to_have_text("robot-1 is frozen")


def test_what_stops_gets_no_key_that_one_types_and_esc_always_stops(
    page: Page, robot: FakeRobot
) -> None:
    page.keyboard.press("?")
    dialog = page.get_by_role("dialog", name="Keys")
    dialog.get_by_role("button", name="Key for: Freeze the robot in focus").click()
    for key in ("q", "Shift+Q", "7", "Backspace", "Control+x"):
        page.keyboard.press(key)
        expect(dialog.get_by_role("status")).to_contain_text("take F1 to F12 or Pause")
    page.keyboard.press("F9")
    expect(dialog.get_by_role("button", name="Key for: Freeze the robot")).to_contain_text("F9")
    dialog.get_by_role("button", name="Close").click()
    page.keyboard.press("/")
    page.keyboard.type("queue")
    for key in ("F9", "Escape"):
        count = len(robot.heard)
        page.keyboard.press(key)
        eventually(lambda count=count: len(robot.heard) == count + 1)
    assert robot.kinds() == [Kind.PAUSE, Kind.PAUSE]


@pytest.mark.parametrize("key", ["Escape", "Process"])
def test_esc_stops_the_robot_while_a_sign_is_being_composed_and_no_other_key_acts(
    page: Page, robot: FakeRobot, key: str
) -> None:
    page.keyboard.press("/")
    expect(page.locator("input[name=words]")).to_be_focused()
    composed = {"isComposing": True}
    page.evaluate(PRESSED, {"key": "2", "code": "Digit2", **composed})
    page.evaluate(PRESSED, {"key": key, "code": "Escape", **composed})
    eventually(lambda: robot.kinds() == [Kind.PAUSE])
    expect(line(page)).to_contain_text("freeze, robot-1: in force since step")
    assert len(robot.heard) == 1


def test_keys_from_before_that_would_be_unsafe_are_forgotten(page: Page, robot: FakeRobot) -> None:
    page.evaluate(REMAPPED, {"freeze": "q", "propose-1": "Escape", "approve": "u"})
    page.reload()
    expect(page.locator(".verdicts .approve kbd")).to_have_text("u")
    expect(page.locator(".verdicts .freeze kbd")).to_have_text("Esc")
    expect(page.locator(".proposal kbd").first).to_have_text("1")
    page.keyboard.press("Escape")
    eventually(lambda: robot.kinds() == [Kind.PAUSE])


def test_the_robot_in_focus_is_the_same_one_after_a_reload_and_after_the_other_pages(
    page: Page, robot: FakeRobot, other: FakeRobot
) -> None:
    page.locator("[data-tile=robot-2]").click()
    expect(focused(page)).to_have_text("robot-2")
    page.reload()
    expect(focused(page)).to_have_text("robot-2")
    page.get_by_role("link", name="Episodes").click()
    expect(page).to_have_url(re.compile("episodes.html"))
    page.get_by_role("link", name="Live").click()
    expect(focused(page)).to_have_text("robot-2")
    page.keyboard.press("Escape")
    eventually(lambda: other.kinds() == [Kind.PAUSE])
    assert robot.heard == []


def test_another_robot_comes_into_focus_when_the_one_from_before_is_gone(page: Page) -> None:
    page.evaluate("sessionStorage.setItem('hld-focused', 'robot-7')")
    page.reload()
    expect(focused(page)).to_have_text("robot-1")


def test_a_phrase_that_esc_broke_off_gives_way_to_the_next_one(
    page: Page, robot: FakeRobot
) -> None:
    field = page.locator("input[name=words]")
    page.keyboard.type("pick up the ham")
    page.keyboard.press("Escape")
    eventually(lambda: robot.kinds() == [Kind.PAUSE])
    page.keyboard.press("Control+z")
    eventually(lambda: robot.kinds() == [Kind.PAUSE, Kind.RESUME])
    page.wait_for_timeout(300)
    page.keyboard.type("wait")
    expect(field).to_have_value("wait")
    page.keyboard.press("Enter")
    eventually(lambda: len(robot.heard) == 3)
    word = robot.heard[2]
    assert word.goal == LanguageGoal(text="wait")
    assert robot.heard[1].created_ns < word.begun_ns  # Not when the first one was begun.


def test_the_key_of_the_field_selects_a_draft_that_an_arrow_keeps(page: Page) -> None:
    field = page.locator("input[name=words]")
    page.keyboard.type("pick up the")
    page.evaluate("document.activeElement.blur()")
    page.keyboard.press("/")
    page.keyboard.press("ArrowRight")
    page.keyboard.type(" ham")
    expect(field).to_have_value("pick up the ham")
    page.evaluate("document.activeElement.blur()")
    page.keyboard.press("/")
    page.keyboard.type("go")
    expect(field).to_have_value("go")


def test_typed_words_are_still_there_when_one_comes_back_to_their_robot(
    page: Page, other: FakeRobot
) -> None:
    page.keyboard.type("pick up the chee")
    page.locator("[data-tile=robot-2]").click()
    field = page.locator("input[name=words]")
    expect(field).to_have_value("")
    page.locator("[data-tile=robot-1]").click()
    expect(field).to_have_value("pick up the chee")
    assert other.heard == []
