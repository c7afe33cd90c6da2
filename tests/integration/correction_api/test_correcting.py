"""Correcting on the live page in a real browser, as a person does it: by keys, words and touch."""

import httpx
from playwright.sync_api import Browser, Page, expect

from shared.messages.correction import Kind
from shared.messages.heartbeat import RobotState
from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.browsing import (
    PHONE,
    focused,
    line,
    opened,
    said,
)
from tests.integration.correction_api.fakes import COMMANDS, FakeRobot
from tests.integration.correction_api.running import eventually

SLIPS = ("cpu", "cip", "cuo", "xup")
RANKED = """
async ([typed, known]) => {
  const { rank } = await import("./fuzzy.js");
  return rank(typed, known, "").map(({ text, guessed }) => [text, guessed]);
}
"""


def test_every_key_says_what_it_stands_for(page: Page, robot: FakeRobot) -> None:
    expected = []
    for key, kind in (
        ("2", Kind.OVERRIDE),
        ("y", Kind.APPROVE),
        ("f", Kind.FAULT),
        ("Shift+Y", Kind.ENDORSE),
        ("r", Kind.RELEASE),
        ("Escape", Kind.PAUSE),
        ("c", Kind.RESUME),
    ):
        page.keyboard.press(key)
        expected.append(kind)
        eventually(lambda expected=expected: robot.kinds() == expected)
        holds = kind in (Kind.OVERRIDE, Kind.PAUSE)
        expect(line(page)).to_contain_text("in force since step" if holds else "heard at step")
        if key == "Escape":
            expect(page.locator(".stopped")).to_be_visible()
        if key == "2":
            expect(page.locator(".who")).to_have_text("told by person")
    assert robot.heard[0].goal is not None
    assert robot.heard[0].goal.text == COMMANDS[1]
    span = robot.heard[3].span
    assert span is not None
    assert span.start == 0


def test_the_stop_works_while_one_types_and_for_all_robots_at_one_press(
    page: Page, robot: FakeRobot, router: MemoryRouter
) -> None:
    with MemoryBus(router) as bus:
        others = [FakeRobot(bus, name) for name in ("robot-2", "robot-3")]
        expect(page.locator(".tile")).to_have_count(3)
        page.keyboard.type("pic")
        expect(page.locator("input[name=words]")).to_have_value("pic")
        page.keyboard.press("Escape")
        eventually(lambda: robot.state is RobotState.PAUSED)
        assert [other.state for other in others] == [RobotState.ACTING] * 2
        expect(page.get_by_role("listbox")).to_have_count(0)
        asked = list[tuple[str, str]]()
        page.on("request", lambda request: asked.append((request.method, request.url)))
        page.keyboard.type("pic")
        page.keyboard.press("Shift+Escape")
        eventually(lambda: all(other.state is RobotState.PAUSED for other in others))
        expect(page.locator(".tile.frozen")).to_have_count(3)
        expect(line(page)).to_have_text("All 3 robots are frozen")
        expect(said(page).first).to_contain_text("in force since step")
        assert [url.rpartition("/")[2] for method, url in asked if method == "POST"] == ["pause"]
        page.locator("[data-tile=robot-3]").click()
        page.get_by_role("button", name="Carry on").click()
        eventually(lambda: others[1].state is RobotState.ACTING)
        assert others[0].state is RobotState.PAUSED
        for other in others:
            other.close()


def test_all_robots_are_frozen_by_a_page_that_shows_none_and_it_says_which_one_is_not(
    browser: Browser, api: httpx.Client, robot: FakeRobot, router: MemoryRouter
) -> None:
    with MemoryBus(router) as bus:
        stubborn = FakeRobot(bus, "robot-2")
        stubborn.reason = "the brake is open"
        eventually(lambda: len(api.get("api/v1/robots").json()["robots"]) == 2)
        page = browser.new_page()
        page.route_web_socket("**/live", lambda _: None)  # Nothing comes to it.
        page.goto(str(api.base_url))
        expect(page.get_by_text("No robot has been heard of yet.")).to_be_visible()
        page.get_by_role("button", name="Freeze all").click()
        expect(line(page)).to_have_text(
            "1 of 2 robots are frozen; robot-2 refused (the brake is open)"
        )
        assert robot.state is RobotState.PAUSED
        page.close()
        stubborn.close()


def test_the_palette_finds_known_commands_by_a_few_letters(page: Page, robot: FakeRobot) -> None:
    page.keyboard.type("pik chese")  # p is no key, so it begins a phrase.
    options = page.locator("[role=option]")
    expect(options.first).to_contain_text("pick up the cheese")
    expect(options.first).to_contain_text("known · in the prompt")
    page.keyboard.press("Enter")
    told = eventually(lambda: robot.heard)[0]
    assert told.goal is not None
    assert told.goal.text == "pick up the cheese"
    expect(page.locator("input[name=words]")).to_have_value("")


def test_a_slip_in_a_word_of_three_letters_finds_it_and_nothing_else(page: Page) -> None:
    cup = "pick up the cup"
    known = ["pick up the ham", cup, "put it in the tub", "put it in the bin"]
    found = {typed: page.evaluate(RANKED, [typed, known]) for typed in ("cup", *SLIPS, "elk")}
    assert found == {"cup": [[cup, False]], **{slip: [[cup, True]] for slip in SLIPS}, "elk": []}


def test_a_slip_in_a_word_that_leads_to_a_thing_finds_nothing_unless_the_thing_is_typed(
    page: Page,
) -> None:
    known = ["pick up the cheese", "pick up the ham", "put it in the tub", "wait"]
    found = {
        typed: [text for text, _ in page.evaluate(RANKED, [typed, known])]
        for typed in ("che", "pick up che", "tha", "pikc", "teh ham", "pikc up ham", "wiat")
    }
    assert found == {
        "che": ["pick up the cheese"],
        "pick up che": ["pick up the cheese"],
        "tha": [],
        "pikc": [],
        "teh ham": ["pick up the ham"],
        "pikc up ham": ["pick up the ham"],
        "wiat": ["wait"],
    }


def test_a_guess_at_a_short_word_stands_below_what_was_typed_and_enter_does_not_say_it(
    page: Page, robot: FakeRobot
) -> None:
    page.keyboard.press("/")
    page.keyboard.type("pick up teh bread")
    options = page.locator("[role=option]")
    expect(options.nth(0)).to_contain_text("pick up teh bread")
    expect(options.nth(1)).to_contain_text("pick up the bread")
    page.keyboard.press("Enter")
    eventually(lambda: robot.heard)
    page.keyboard.press("/")
    page.keyboard.type("pick up teh bread")
    expect(options.nth(1)).to_contain_text("pick up the bread")
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Enter")
    eventually(lambda: len(robot.heard) == 2)
    said = [one.goal.text for one in robot.heard if one.goal]
    assert said == ["pick up teh bread", "pick up the bread"]


def test_a_new_phrase_is_marked_as_new_and_the_nearest_known_ones_stand_beside_it(
    page: Page, robot: FakeRobot
) -> None:
    page.keyboard.press("/")
    page.keyboard.type("<b>seize</b> the yellow slice")
    option = page.locator("[role=option].new")
    expect(option).to_contain_text(f"new to the low level · taken for “{COMMANDS[0]}”")
    near = page.locator("[role=option].near")
    expect(near).to_have_count(2)
    expect(near.first).to_contain_text("nearest known · 50 %")
    page.get_by_label("How long it holds").select_option("250")
    page.locator("input[name=words]").press("Enter")
    told = eventually(lambda: robot.heard)[0]
    assert told.goal is not None
    assert (told.goal.text, told.hold_steps) == ("<b>seize</b> the yellow slice", 250)
    expect(page.locator(".caption q")).to_have_text("<b>seize</b> the yellow slice")
    expect(said(page).first).to_contain_text("new to the low level")


def test_a_phrase_that_would_be_refused_says_why_and_a_click_takes_a_near_one(
    page: Page, robot: FakeRobot
) -> None:
    page.locator("input[name=words]").click()
    page.keyboard.type("dance a little")
    option = page.locator("[role=option].refused")
    expect(option).to_contain_text("would be refused")
    expect(option).to_contain_text("the low level doesn't understand 'dance a little'")
    assert robot.heard == []
    page.locator("[role=option].near").last.click()
    told = eventually(lambda: robot.heard)[0]
    assert told.goal is not None
    assert told.goal.text == COMMANDS[4]


def test_what_one_said_last_is_taken_back_and_the_robot_is_its_policys_again(
    page: Page, robot: FakeRobot, api: httpx.Client
) -> None:
    page.keyboard.press("2")
    expect(page.locator(".who")).to_have_text("told by person")
    other = {"kind": "approve", "decision": "robot-1-e1-0", "author": "bea"}
    api.post("api/v1/robots/robot-1/corrections", json=other).raise_for_status()
    page.keyboard.press("Control+z")
    eventually(lambda: robot.kinds() == [Kind.OVERRIDE, Kind.APPROVE, Kind.RETRACT])
    assert robot.heard[2].target == robot.heard[0].id
    expect(page.locator(".who")).to_have_text("chosen by π_HL 1.0")
    expect(said(page).last).to_contain_text("taken back")
    page.keyboard.press("Control+z")
    expect(line(page)).to_have_text("There is nothing of yours to take back")
    assert len(robot.heard) == 3


def test_keys_can_be_given_away_are_refused_when_taken_and_come_back(
    page: Page, robot: FakeRobot
) -> None:
    page.keyboard.press("?")
    dialog = page.get_by_role("dialog", name="Keys")
    expect(dialog.locator("li")).to_have_count(24)
    dialog.get_by_role("button", name="Key for: That is right").click()
    page.keyboard.press("r")
    expect(dialog.get_by_role("status")).to_have_text(
        "r is taken: it does “Release: the policy decides again”. Give that another key first."
    )
    page.keyboard.press("u")
    expect(dialog.get_by_role("button", name="Key for: That is right, now u")).to_be_visible()
    dialog.get_by_role("button", name="Close").click()
    page.reload()
    expect(page.locator(".verdicts .approve kbd")).to_have_text("u")
    page.keyboard.press("u")
    eventually(lambda: robot.kinds() == [Kind.APPROVE])
    page.keyboard.press("?")
    dialog.get_by_role("button", name="Reset all").click()
    dialog.get_by_role("button", name="Close").click()
    expect(page.locator(".verdicts .approve")).to_have_attribute("aria-keyshortcuts", "y")


def test_single_keys_can_be_turned_off_but_not_the_stop(page: Page, robot: FakeRobot) -> None:
    page.keyboard.press("?")
    page.get_by_label("Single keys act").uncheck()
    page.get_by_role("button", name="Close").click()
    page.keyboard.press("y")
    page.keyboard.press("2")
    page.keyboard.press("Escape")
    eventually(lambda: robot.kinds() == [Kind.PAUSE])


def test_all_of_it_can_be_done_by_touch(
    browser: Browser, api: httpx.Client, robot: FakeRobot, router: MemoryRouter
) -> None:
    robot.decide()
    with MemoryBus(router) as bus:
        other = FakeRobot(bus, "robot-2")
        with opened(browser, api, PHONE, has_touch=True, is_mobile=True) as page:
            expect(page.locator(".tile")).to_have_count(2)
            for name, kind in (
                (COMMANDS[1], Kind.OVERRIDE),
                ("That is right", Kind.APPROVE),
                ("Hand slipped", Kind.FAULT),
                ("Release", Kind.RELEASE),
                ("Take back", Kind.RETRACT),
                ("Freeze", Kind.PAUSE),
            ):
                count = len(robot.heard)
                button = page.locator(".panel button", has_text=name)
                box = button.bounding_box()
                assert box
                assert box["height"] >= 44
                button.tap()
                eventually(lambda count=count: len(robot.heard) == count + 1)
                assert robot.heard[-1].kind is kind
                if kind is Kind.OVERRIDE:
                    expect(page.locator(".who")).to_have_text("told by person")
            page.locator("[data-tile=robot-2]").tap()
            expect(focused(page)).to_have_text("robot-2")
            assert other.heard == []
            page.get_by_role("button", name="Freeze all").tap()
            eventually(lambda: other.state is RobotState.PAUSED)
            expect(line(page)).to_have_text("Both robots are frozen")
            assert (other.kinds(), robot.kinds()[-1]) == ([Kind.PAUSE], Kind.PAUSE)
            assert page.evaluate("document.documentElement.scrollWidth") <= PHONE[0]
        other.close()
