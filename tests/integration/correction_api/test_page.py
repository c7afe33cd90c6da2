"""The live page in a real browser: what one sees of the robots, and of what was said."""

import re
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Browser, expect

from shared.messages.frame import Channel, Rate
from shared.messages.policy import Version
from shared.wire.keys import robot_key
from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.browsing import (
    DESK,
    PHONE,
    TABLET,
    focused,
    line,
    opened,
    said,
)
from tests.integration.correction_api.fakes import COMMANDS, FLEET, FakeLearner, FakeRobot
from tests.integration.correction_api.running import eventually, running
from tests.integration.correction_api.visiting import visited


def watched(router: MemoryRouter, robot: str) -> dict[str, bool]:
    """Which channels of a robot's angle camera somebody looks at."""
    channels = {rate: Channel("angle", rate).message for rate in Rate}
    return {
        str(rate): router.watched(robot_key(FLEET, robot, name)) for rate, name in channels.items()
    }


@pytest.mark.parametrize("size", [DESK, PHONE])
def test_a_click_on_a_proposal_is_obeyed_and_the_step_is_told(
    browser: Browser, api: httpx.Client, robot: FakeRobot, size: tuple[int, int]
) -> None:
    robot.decide()
    with opened(browser, api, size, has_touch=size is PHONE) as page:
        focus = page.locator(".focus")
        expect(focus.locator(".prompt")).to_have_text("make a sandwich with cheese and tomato")
        expect(focus.locator(".caption q")).to_have_text(COMMANDS[0])
        expect(focus.locator(".who")).to_have_text("chosen by π_HL 1.0")
        expect(focus.locator("canvas.drawn")).to_have_count(2)
        button = page.locator(".proposal", has_text=COMMANDS[2])
        button.tap() if size is PHONE else button.click()
        expect(line(page)).to_contain_text(f"“{COMMANDS[2]}”, robot-1: in force since step ")
        told = robot.heard[0]
        step = robot.receipts[told.id].step
        expect(said(page).first).to_contain_text(f"in force since step {step}")
        expect(focus.locator(".caption q")).to_have_text(COMMANDS[2])
        expect(focus.locator(".who")).to_have_text("told by person")
        expect(focus.locator(".course li").last).to_contain_text(COMMANDS[2])
        assert page.evaluate("document.documentElement.scrollWidth") <= size[0]
    assert (told.author, told.decision, told.hold_steps) == ("person", "robot-1-e1-0", None)


def test_a_correction_names_the_step_of_the_picture_that_was_seen_and_when_it_was_begun(
    browser: Browser, api: httpx.Client, robot: FakeRobot
) -> None:
    robot.decide()
    with opened(browser, api) as page:
        expect(page.locator(".focus canvas.angle.drawn")).to_have_count(1)
        page.keyboard.press("/")
        robot.deaf = True  # No picture and no step comes any more.
        page.wait_for_timeout(300)
        shown = robot.step
        expect(page.locator(".focus canvas.angle")).to_have_attribute("data-step", str(shown))
        robot.step = shown + 400
        page.keyboard.type("wa")
        page.wait_for_timeout(300)
        page.keyboard.type("it")
        page.keyboard.press("Enter")
        told = eventually(lambda: robot.heard)[0]
    assert told.seen_step == shown
    assert 0.25e9 < told.created_ns - told.begun_ns < 60e9


def test_who_has_scrolled_the_picture_away_corrects_the_newest_decision_and_no_old_picture(
    browser: Browser, api: httpx.Client, robot: FakeRobot
) -> None:
    robot.decide()
    with opened(browser, api, PHONE, has_touch=True) as page:
        picture = page.locator(".focus canvas.angle.drawn")
        expect(picture).to_have_count(1)
        page.evaluate("document.documentElement.style.paddingBottom = '2000px'")
        page.evaluate("scrollTo(0, 2000)")
        expect(picture).not_to_be_in_viewport()
        page.wait_for_timeout(300)  # The page has seen that, too.
        robot.deaf = True  # No step comes any more but by its next decision.
        robot.step += 400
        robot.command = COMMANDS[4]
        decision = robot.decide()
        expect(page.locator(".focus .caption q")).to_have_text(COMMANDS[4])
        page.keyboard.press("3")
        told = eventually(lambda: robot.heard)[0]
    assert told.seen_step == decision.step


def test_only_the_robot_in_focus_is_seen_at_full_rate_and_a_hidden_page_sees_nothing(
    browser: Browser, api: httpx.Client, robot: FakeRobot, router: MemoryRouter
) -> None:
    robot.decide()
    full, slow = {"full": True, "slow": False}, {"full": False, "slow": True}
    none = {"full": False, "slow": False}

    def both() -> tuple[dict[str, bool], ...]:
        return watched(router, "robot-1"), watched(router, "robot-2")

    with MemoryBus(router) as bus:
        other = FakeRobot(bus, "robot-2")
        with opened(browser, api) as page:
            expect(page.locator(".tile canvas.drawn")).to_have_count(2)
            eventually(lambda: both() == (full, slow))
            page.locator("[data-tile=robot-2]").click()
            expect(focused(page)).to_have_text("robot-2")
            eventually(
                lambda: (watched(router, "robot-1"), watched(router, "robot-2")) == (slow, full)
            )
            page.evaluate(
                "Object.defineProperty(document, 'hidden', {get: () => true});"
                "document.dispatchEvent(new Event('visibilitychange'))"
            )
            eventually(
                lambda: (watched(router, "robot-1"), watched(router, "robot-2")) == (none, none)
            )
        other.close()


@pytest.mark.parametrize("size", [DESK, TABLET])
def test_eight_robots_fit_on_the_screen_without_scrolling(
    browser: Browser,
    api: httpx.Client,
    robot: FakeRobot,
    router: MemoryRouter,
    size: tuple[int, int],
) -> None:
    robot.decide()
    with MemoryBus(router) as bus:
        others = [FakeRobot(bus, f"robot-{number}") for number in range(2, 9)]
        with opened(browser, api, size) as page:
            expect(page.locator(".tile")).to_have_count(8)
            for tile in page.locator(".tile").all():
                box = tile.bounding_box()
                assert box
                assert box["x"] + box["width"] <= size[0]
                assert box["y"] + box["height"] <= size[1]
            height = page.evaluate("document.documentElement.scrollHeight")
            assert height <= size[1]
            page.keyboard.press("g")
            page.keyboard.press("5")
            expect(focused(page)).to_have_text("robot-5")
            page.keyboard.press("ArrowRight")
            expect(focused(page)).to_have_text("robot-6")
        for other in others:
            other.close()


def test_robots_in_doubt_are_marked_and_a_key_goes_from_one_to_the_next(
    browser: Browser, api: httpx.Client, robot: FakeRobot, router: MemoryRouter
) -> None:
    robot.decide()
    with MemoryBus(router) as bus:
        others = [FakeRobot(bus, name) for name in ("robot-2", "robot-3")]
        with opened(browser, api) as page:
            expect(page.locator(".tile")).to_have_count(3)
            expect(page.locator(".in-doubt")).to_have_count(0)
            others[0].ask(doubt=0.5)
            others[1].ask(doubt=0.4, waits_s=60)
            expect(page.get_by_role("button", name="2 in doubt")).to_be_visible()
            expect(page.locator("[data-tile=robot-2] .doubt")).to_have_text("? in doubt 50 %")
            for name, doubt in (("robot-3", 40), ("robot-2", 50), ("robot-3", 40)):
                page.keyboard.press("n")
                expect(focused(page)).to_have_text(name)
                expect(line(page)).to_have_text(f"{name} is in focus: in doubt {doubt} %")
            page.keyboard.press("ArrowLeft")
            expect(line(page)).to_have_text("robot-2 is in focus: in doubt 50 %")
            page.keyboard.press("ArrowLeft")
            expect(line(page)).to_have_text("robot-1 is in focus: acting")
            page.keyboard.press("n")
            expect(focused(page)).to_have_text("robot-3")
            expect(page.locator(".focus .doubt")).to_contain_text("waits")
            page.keyboard.press("y")
            expect(page.get_by_role("button", name="1 in doubt")).to_be_visible()
        for other in others:
            other.close()


def test_pictures_that_give_way_to_the_control_loop_are_told(
    browser: Browser, api: httpx.Client, robot: FakeRobot
) -> None:
    with opened(browser, api) as page:
        slowed = page.locator(".focus .title").get_by_text("pictures slowed")
        expect(page.locator(".focus .title b")).to_have_count(2)
        expect(slowed).to_have_count(0)
        robot.pictures = 0.1
        expect(slowed).to_be_visible()
        robot.pictures = 1.0
        expect(slowed).to_have_count(0)


def test_for_how_long_a_robot_is_offline_counts_on_while_nothing_is_heard_of_it(
    browser: Browser, router: MemoryRouter, robot: FakeRobot, other: FakeRobot, tmp_path: Path
) -> None:
    watch = {"stale_s": 0.5, "offline_s": 1.0}
    with MemoryBus(router) as bus, running(bus, tmp_path, watch=watch) as api:
        eventually(lambda: len(api.get("api/v1/robots").json()["robots"]) == 2)
        with opened(browser, api) as page:
            expect(page.locator(".tile")).to_have_count(2)
            robot.deaf = other.deaf = True
            later = re.compile(r"^offline for (?!1 |2 )\d+ s$")  # It is told after a second, once.
            expect(page.locator(".focus .doing")).to_have_text(later)
            expect(page.locator("[data-tile=robot-2] .doing")).to_have_text(later)
            robot.deaf = False
            expect(page.locator(".focus .doing")).to_have_text("acting")
            told = page.evaluate(
                "async robot => (await import('./words.js')).doing("
                "{ ...robot, heardMs: performance.now() })",
                {"presence": "offline", "age_s": 190.0},
            )
            assert told == "offline for 3 min"


def test_what_is_too_early_for_the_strip_is_in_the_player(
    browser: Browser, api: httpx.Client, robot: FakeRobot
) -> None:
    def course() -> int:
        return len(api.get("api/v1/robots/robot-1").json()["course"])

    for number in range(1, 11):
        robot.command = COMMANDS[number % 2]
        robot.beat()
        eventually(lambda number=number: course() == number + 1)
    with visited(browser, str(api.base_url)) as page:
        page.get_by_role("link", name="3 before", exact=True).click()
        expect(page).to_have_url(re.compile(f"/episode.html\\?id={robot.episode}$"))
        expect(page.get_by_role("heading", name="An episode that is not over yet")).to_be_visible()
        page.go_back()
        for number in range(11, 64):
            robot.command = COMMANDS[number % 2]
            robot.beat()
            eventually(lambda number=number: course() == number + 1)
        expect(page.get_by_role("link", name="56 or more before", exact=True)).to_be_visible()


def test_a_correction_goes_from_pending_to_in_force_to_learned_and_stays_so_after_a_rollback(
    browser: Browser, api: httpx.Client, robot: FakeRobot, learner: FakeLearner
) -> None:
    robot.decide()
    with opened(browser, api) as page:
        expect(page.locator(".proposal")).to_have_count(len(COMMANDS))
        robot.answering.clear()
        page.keyboard.press("2")
        expect(said(page).first.locator(".where")).to_have_text("pending")
        expect(line(page)).to_have_text(f"“{COMMANDS[1]}”, robot-1: pending")
        assert robot.receipts == {}
        robot.answering.set()
        expect(said(page).first).to_contain_text("in force since step")
        page.keyboard.press("y")
        eventually(lambda: len(robot.receipts) == 2)
        expect(said(page)).to_have_count(2)
        command, verdict = robot.receipts
        learner.learned[command] = Version(1, 1)
        learner.held_out.add(verdict)
        learner.announce("1.1")
        expect(said(page).last).to_contain_text("→ learned in 1.1")
        expect(said(page).first).to_contain_text("→ held out as a test")
        learner.announce("1.2")  # The weights of 1.0 again.
        page.reload()
        expect(said(page).last).to_contain_text("→ learned in 1.1")


def test_a_refusal_and_a_lost_connection_are_told(
    browser: Browser, router: MemoryRouter, tmp_path: Path
) -> None:
    with MemoryBus(router) as bus, MemoryBus(router) as robots:
        robot = FakeRobot(robots)
        with running(bus, tmp_path) as api:
            eventually(lambda: api.get("api/v1/robots").json()["robots"])
            robot.decide()
            page = browser.new_page()
            page.goto(str(api.base_url))
            expect(page.locator(".proposal")).to_have_count(len(COMMANDS))
            robot.deaf, robot.episode = True, "robot-1-e9"
            page.locator(".proposal", has_text=COMMANDS[1]).click()
            why = "refused, since episode robot-1-e1 is over; the current one is robot-1-e9"
            expect(line(page)).to_contain_text(why)
            expect(said(page).first).to_contain_text(why)
        expect(page.locator(".banner")).to_have_text("No connection …")
        page.close()
        robot.close()


def test_the_routes_can_be_read_with_their_examples(browser: Browser, api: httpx.Client) -> None:
    with opened(browser, api, path="docs") as page:
        expect(page.locator(".route")).to_have_count(26)
        route = page.locator(".route", has_text="/api/v1/robots/{robot}/corrections")
        route.locator("summary").click()
        expect(route.locator("pre").first).to_contain_text('"text": "pick up the cheese"')


def test_a_page_of_a_service_with_a_token_asks_for_it_once(
    browser: Browser, router: MemoryRouter, robot: FakeRobot, tmp_path: Path
) -> None:
    token = "0123456789abcdef"
    with MemoryBus(router) as bus, running(bus, tmp_path, token=token) as api:
        assert api.get("api/v1/robots").status_code == 401
        robot.decide()
        page = browser.new_page()
        page.goto(str(api.base_url))
        page.get_by_label("Token of this service").fill(token)
        page.get_by_role("button", name="Open").click()
        expect(page.locator("canvas.drawn")).to_have_count(2)
        page.locator(".verdicts .freeze").click()
        expect(line(page)).to_contain_text("in force since step")
        page.close()
