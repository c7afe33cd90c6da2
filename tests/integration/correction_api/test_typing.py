"""Keys of the live page and sentences of a person: neither is ever taken for the other."""

import pytest
from playwright.sync_api import Locator, Page, expect

from shared.messages.correction import Kind
from shared.messages.heartbeat import RobotState
from tests.integration.correction_api.browsing import focused, line
from tests.integration.correction_api.fakes import COMMANDS, FakeRobot
from tests.integration.correction_api.running import eventually

SENTENCES = (
    "grab the cheese",
    "from the left",
    "no, the cheese",
    "release it",
    "yellow slice",
    "Yes, the bread",
    "carry it over",
    "rye bread",
    "crumbs off",
)
"""Each begins with a letter that is a key."""
YNGLING = "pick up the yngling"
LISTED = "async () => (await import('./scene.js')).listed('robot-1')"
PRESSED = """
async keys => {
  const { state } = await import("./store.js");
  const down = key => new KeyboardEvent("keydown", { key, bubbles: true });
  for (const key of keys) document.body.dispatchEvent(down(key));
  return Object.values(state.sending).map(({ words }) => words.kind);
}
"""
"""What is on its way to the service after some keys, before any time has passed."""


def stop_clock(page: Page) -> None:
    """From now on the page's time passes by `run_for` alone: a letter waits for half a second."""
    page.clock.install()
    page.clock.pause_at(page.evaluate("Date.now()") / 1000 + 3)


def words(page: Page) -> Locator:
    """The field for words of one's own."""
    return page.locator("input[name=words]")


@pytest.mark.parametrize("pause_ms", [0, 240])
def test_no_typed_sentence_is_taken_for_a_key(
    page: Page, robot: FakeRobot, other: FakeRobot, pause_ms: int
) -> None:
    expect(page.locator(".tile")).to_have_count(2)
    page.keyboard.press("2")
    eventually(lambda: robot.heard)
    other.ask()
    expect(page.get_by_role("button", name="1 in doubt")).to_be_visible()
    stop_clock(page)
    for sentence in SENTENCES:
        for sign in sentence:
            page.keyboard.type(sign)
            page.clock.run_for(pause_ms)
        expect(words(page)).to_have_value(sentence)
        words(page).fill("")
        words(page).blur()
    page.clock.run_for(700)
    expect(focused(page)).to_have_text("robot-1")
    assert robot.kinds() + other.kinds() == [Kind.OVERRIDE]


@pytest.mark.parametrize(("key", "kind"), [("y", Kind.APPROVE), ("r", Kind.RELEASE)])
def test_two_letters_that_begin_no_word_act_both_at_once_and_in_order(
    page: Page, robot: FakeRobot, other: FakeRobot, key: str, kind: Kind
) -> None:
    expect(page.locator(".tile")).to_have_count(2)
    page.keyboard.press("2")
    expect(page.locator(".who")).to_have_text("told by person")
    other.ask()
    expect(page.get_by_role("button", name="1 in doubt")).to_be_visible()
    stop_clock(page)
    page.keyboard.press(key)
    page.clock.run_for(200)
    page.keyboard.press("n")
    page.clock.run_for(100)  # Neither waits any longer.
    expect(focused(page)).to_have_text("robot-2")
    eventually(lambda: robot.kinds() == [Kind.OVERRIDE, kind])
    expect(words(page)).to_have_value("")
    assert other.heard == []


def test_no_letter_acts_at_once_on_a_robot_that_another_letter_has_just_brought_into_focus(
    page: Page, robot: FakeRobot, other: FakeRobot
) -> None:
    expect(page.locator(".tile")).to_have_count(2)
    other.ask()
    expect(page.get_by_role("button", name="1 in doubt")).to_be_visible()
    stop_clock(page)
    page.keyboard.press("n")
    page.keyboard.press("y")
    page.clock.run_for(100)
    expect(focused(page)).to_have_text("robot-2")
    expect(line(page)).to_have_text("y …: That is right")
    page.keyboard.press("Backspace")
    page.clock.run_for(700)
    page.keyboard.press("n")
    page.keyboard.press("y")
    page.clock.run_for(700)
    eventually(lambda: other.kinds() == [Kind.APPROVE])
    assert robot.heard == []


def test_two_letters_with_which_a_known_command_has_a_word_are_typed(
    page: Page, robot: FakeRobot
) -> None:
    bank = {"commands": [*COMMANDS, YNGLING], "asked": True}
    page.route("**/commands", lambda route: route.fulfill(json=bank))
    page.reload()
    eventually(lambda: YNGLING in page.evaluate(LISTED))
    page.keyboard.type("yngling")
    expect(words(page)).to_have_value("yngling")
    expect(page.locator("[role=option]").first).to_contain_text(YNGLING)
    assert robot.heard == []


def test_a_letter_that_waits_is_about_what_was_seen_when_it_was_pressed(
    page: Page, robot: FakeRobot, other: FakeRobot
) -> None:
    expect(page.locator(".tile")).to_have_count(2)
    page.keyboard.press("y")
    robot.decide()
    page.locator("[data-tile=robot-2]").click()
    told = eventually(lambda: robot.heard)[0]
    assert (told.kind, told.decision) == (Kind.APPROVE, "robot-1-e1-0")
    assert other.heard == []


def test_digits_and_the_stop_wait_for_nothing_and_the_stop_ends_what_waits(
    page: Page, robot: FakeRobot
) -> None:
    stop_clock(page)
    page.keyboard.press("Escape")
    eventually(lambda: robot.state is RobotState.PAUSED)
    page.keyboard.press("c")
    page.keyboard.press("Escape")
    page.clock.run_for(700)
    eventually(lambda: len(robot.heard) == 2)
    eventually(lambda: page.evaluate(PRESSED, []) == [])  # Both are answered, too.
    assert page.evaluate(PRESSED, ["y", "3"]) == ["approve", "override"]
    eventually(lambda: len(robot.heard) == 4)
    kinds = robot.kinds()  # The last two went out together.
    assert (kinds[:2], set(kinds[2:])) == ([Kind.PAUSE] * 2, {Kind.APPROVE, Kind.OVERRIDE})


def test_enter_makes_a_letter_act_at_once_and_backspace_makes_it_do_nothing(
    page: Page, robot: FakeRobot
) -> None:
    stop_clock(page)
    page.keyboard.press("f")
    page.clock.run_for(100)
    expect(line(page)).to_have_text("f …: Right, but the hand slipped")
    page.keyboard.press("Backspace")
    page.keyboard.press("y")
    page.keyboard.press("Enter")
    eventually(lambda: robot.heard)
    page.clock.run_for(700)
    assert robot.kinds() == [Kind.APPROVE]
    expect(words(page)).to_have_value("")
