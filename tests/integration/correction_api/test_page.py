"""The page in a real browser: one sees the robot, clicks a command, and is told since when."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Browser, Page, Playwright, expect, sync_playwright

from shared.messages.correction import Kind
from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.fakes import COMMANDS, FakeRobot
from tests.integration.correction_api.running import eventually, running

FLAGS = [
    "--no-sandbox",  # Tests may run as root in a container.
    "--disable-gpu",
    "--disable-dev-shm-usage",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
]
SIZES = [(1280, 900), (390, 844)]


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """Debian's Chromium, without a screen."""
    path = shutil.which("chromium")
    assert path, "no chromium: apt-get install chromium"
    expect.set_options(timeout=15_000)  # For machines that are busy with something else.
    with sync_playwright() as playwright:
        browser = _launch(playwright, path)
        yield browser
        browser.close()


def _launch(playwright: Playwright, path: str) -> Browser:
    return playwright.chromium.launch(executable_path=path, args=FLAGS)


@contextmanager
def opened(
    browser: Browser, api: httpx.Client, size: tuple[int, int] = SIZES[0], path: str = ""
) -> Iterator[Page]:
    """The page; it must not complain, nor ask anybody but its own origin."""
    page = browser.new_page(viewport={"width": size[0], "height": size[1]})
    page.set_default_timeout(10_000)
    complaints, asked = list[str](), list[str]()
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("console", lambda message: complaints.append(message.text))
    page.on("request", lambda request: asked.append(request.url))
    page.on("websocket", lambda socket: asked.append(socket.url.replace("ws:", "http:")))
    page.goto(str(api.base_url.join(path)))
    yield page
    page.close()
    assert complaints == []
    assert asked
    assert [url for url in asked if not url.startswith(str(api.base_url))] == []


@pytest.mark.parametrize("size", SIZES)
def test_a_click_on_a_proposal_is_obeyed_and_the_step_is_told(
    browser: Browser, api: httpx.Client, robot: FakeRobot, size: tuple[int, int]
) -> None:
    robot.decide()
    with opened(browser, api, size) as page:
        card = page.locator("[data-robot=robot-1]")
        expect(card.locator(".prompt")).to_have_text("make a sandwich with cheese and tomato")
        expect(card.locator(".caption q")).to_have_text(COMMANDS[0])
        expect(card.locator(".who")).to_have_text("chosen by policy 1.0")
        expect(card.locator("canvas.drawn")).to_have_count(2)
        card.get_by_role("button", name=COMMANDS[2]).click()
        status = card.get_by_role("status")
        expect(status).to_contain_text(f"“{COMMANDS[2]}”: in force since step ")
        said = robot.heard[0]
        step = robot.receipts[said.id].step
        expect(status).to_have_text(f"“{COMMANDS[2]}”: in force since step {step}")
        expect(card.locator(".caption q")).to_have_text(COMMANDS[2])
        expect(card.locator(".who")).to_have_text("told by person")
        expect(card.locator(".history li")).to_have_count(1)
        width = page.evaluate("document.documentElement.scrollWidth")
        assert width <= size[0]
    assert (said.author, said.decision, said.hold_steps) == ("person", "robot-1-e1-0", None)
    assert said.seen_step is not None


def test_words_keys_and_buttons_all_reach_the_robot(
    browser: Browser, api: httpx.Client, robot: FakeRobot
) -> None:
    robot.decide()
    with opened(browser, api) as page:
        card = page.locator("[data-robot=robot-1]")
        expect(card.locator(".proposal")).to_have_count(len(COMMANDS))
        page.locator("input[name=author]").fill("Anna B")
        page.keyboard.press("Tab")
        page.locator("body").press("/")
        page.keyboard.type("<b>1</b> pick up the cheese, gently")
        card.get_by_label("How long it holds").select_option("250")
        card.get_by_role("button", name="Say").click()
        expect(card.get_by_role("status")).to_contain_text("in force since step")
        expect(card.locator(".caption q")).to_have_text("<b>1</b> pick up the cheese, gently")
        card.locator(".prompt").click()
        page.keyboard.press("2")
        expect(card.locator(".caption q")).to_have_text(COMMANDS[1])
        for count, key in ((3, "y"), (4, "r"), (5, "Escape")):
            page.keyboard.press(key)
            eventually(lambda count=count: len(robot.heard) == count)
            expect(card.get_by_role("status")).to_contain_text("in force")
    assert [said.kind for said in robot.heard] == [
        Kind.OVERRIDE,
        Kind.OVERRIDE,
        Kind.APPROVE,
        Kind.RELEASE,
        Kind.PAUSE,
    ]
    assert (robot.heard[0].author, robot.heard[0].hold_steps) == ("anna-b", 250)
    assert robot.heard[1].goal is not None
    assert robot.heard[1].goal.text == COMMANDS[1]


def test_robots_in_doubt_are_marked_and_a_key_goes_from_one_to_the_next(
    browser: Browser, api: httpx.Client, robot: FakeRobot, router: MemoryRouter
) -> None:
    robot.decide()
    with MemoryBus(router) as bus:
        others = [FakeRobot(bus, name) for name in ("robot-2", "robot-3")]
        with opened(browser, api) as page:
            expect(page.locator("article.robot")).to_have_count(3)
            expect(page.locator(".in-doubt")).to_have_count(0)
            others[0].ask(doubt=0.5)
            others[1].ask(doubt=0.4, waits_s=60)
            expect(page.get_by_role("button", name="2 in doubt")).to_be_visible()
            expect(page.locator("[data-robot=robot-2] .doubt")).to_have_text("in doubt 50 %")
            expect(page.locator("[data-robot=robot-3] .doubt")).to_contain_text("waits")
            focused = page.locator("article.focused h2")
            for name in ("robot-3", "robot-2", "robot-3"):
                page.keyboard.press("n")
                expect(focused).to_have_text(name)
            page.keyboard.press("y")
            expect(page.get_by_role("button", name="1 in doubt")).to_be_visible()
        for other in others:
            other.close()


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
            card = page.locator("[data-robot=robot-1]")
            expect(card.locator(".proposal")).to_have_count(len(COMMANDS))
            robot.deaf, robot.episode = True, "robot-1-e9"
            card.get_by_role("button", name=COMMANDS[1]).click()
            expect(card.get_by_role("status")).to_contain_text(
                "refused because episode robot-1-e1 is over; the current one is robot-1-e9"
            )
        expect(page.get_by_role("alert")).to_have_text("No connection …")
        page.close()
        robot.close()


def test_the_routes_can_be_read_with_their_examples(browser: Browser, api: httpx.Client) -> None:
    with opened(browser, api, path="docs") as page:
        expect(page.locator(".route")).to_have_count(12)
        said = page.locator(".route", has_text="/api/v1/robots/{robot}/corrections")
        said.locator("summary").click()
        expect(said.locator("pre").first).to_contain_text('"text": "pick up the cheese"')


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
        page.get_by_role("button", name="Pause").click()
        expect(page.get_by_role("status")).to_contain_text("in force since step")
        page.close()
