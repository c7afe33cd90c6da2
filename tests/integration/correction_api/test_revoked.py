"""Whose token is no longer good is told so, on every page, and goes on with a new one."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest
from playwright.sync_api import Browser, Page, expect

from deploy.ports import free_port
from services.correction_api.people import fresh_token, hashed
from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.browsing import DESK, PATIENCE_MS, PHONE
from tests.integration.correction_api.fakes import COMMANDS, FakeRobot
from tests.integration.correction_api.running import eventually, running
from tests.integration.correction_api.test_access import violations

ANNA, BEN = fresh_token(), fresh_token()
PEOPLE = {"anna": hashed(ANNA), "ben": hashed(BEN)}
WITHOUT_ANNA = {"ben": hashed(BEN)}
REFUSED = "The token of this page is not good here, or no longer"
LATER_MS = 60_000  # By then every pause between two attempts is over.


class Service:
    """An API that is started again and again in one place, and a robot."""

    def __init__(self, router: MemoryRouter, robot: FakeRobot, folder: Path) -> None:
        self._router, self._robot, self._folder = router, robot, folder
        self._port = free_port()
        self.url = f"http://127.0.0.1:{self._port}/"

    @contextmanager
    def started(self, **settings: Any) -> Iterator[None]:
        with MemoryBus(self._router) as bus:
            with running(bus, self._folder, port=self._port, **settings):
                headers = {"Authorization": f"Bearer {BEN}"}
                robots = f"{self.url}api/v1/robots"
                eventually(lambda: httpx.get(robots, headers=headers).json()["robots"])
                self._robot.decide()
                yield


@pytest.fixture
def service(router: MemoryRouter, robot: FakeRobot, tmp_path: Path) -> Service:
    return Service(router, robot, tmp_path)


@contextmanager
def opened(browser: Browser, size: tuple[int, int] = DESK) -> Iterator[Page]:
    """An empty page, in which no script may fail; that a service is away is no fault of it."""
    page = browser.new_page(viewport={"width": size[0], "height": size[1]})
    page.set_default_timeout(PATIENCE_MS)
    failed = list[str]()
    page.on("pageerror", lambda error: failed.append(str(error)))
    yield page
    page.close()
    assert failed == []


def unlock(page: Page, token: str) -> None:
    page.get_by_label("Token of this service").fill(token)
    page.get_by_role("button", name="Open").click()


def locked(page: Page) -> None:
    """The form is there with its reason, and nothing is asked any more, however long one waits."""
    expect(page.get_by_role("alert")).to_contain_text(REFUSED)
    asked = list[str]()
    page.on("request", lambda request: asked.append(request.url))
    page.on("websocket", lambda socket: asked.append(socket.url))
    page.clock.fast_forward(LATER_MS)
    page.clock.fast_forward(LATER_MS)
    page.wait_for_load_state("networkidle")
    assert asked == []


@pytest.mark.parametrize("size", [DESK, PHONE])
def test_the_live_page_of_whoever_was_shut_out_says_so_and_a_new_token_goes_on(
    browser: Browser, service: Service, robot: FakeRobot, size: tuple[int, int]
) -> None:
    with opened(browser, size) as page:
        page.clock.install()
        with service.started(people=PEOPLE):
            page.goto(service.url)
            unlock(page, ANNA)
            expect(page.locator(".proposal")).to_have_count(len(COMMANDS))
        with service.started(people=WITHOUT_ANNA):
            locked(page)
            page.keyboard.press("Shift+Escape")
            page.keyboard.press("2")
            assert violations(page) == []
            assert page.evaluate("document.documentElement.scrollWidth") <= size[0]
            unlock(page, "x" * 24)
            expect(page.get_by_role("alert")).to_contain_text(REFUSED)
            assert robot.heard == []
            unlock(page, BEN)
            expect(page.locator("input[name=author]")).to_have_value("ben")
            expect(page.locator(".proposal")).to_have_count(len(COMMANDS))
            page.keyboard.press("Escape")
            eventually(lambda: robot.heard)
    assert [said.author for said in robot.heard] == ["ben"]


def test_a_service_that_was_started_again_and_still_knows_the_token_is_found_again(
    browser: Browser, service: Service
) -> None:
    with opened(browser) as page:
        with service.started(people=PEOPLE):
            page.goto(service.url)
            unlock(page, BEN)
            expect(page.locator(".proposal")).to_have_count(len(COMMANDS))
        expect(page.locator(".banner")).to_have_text("No connection …")
        with service.started(people=WITHOUT_ANNA):
            expect(page.locator(".banner")).to_have_count(0)
            expect(page.locator(".proposal")).to_have_count(len(COMMANDS))


@contextmanager
def tabs(browser: Browser) -> Iterator[Callable[[str], Page]]:
    """Opens tabs of one browser; the token stands in no address that they ask for."""
    context = browser.new_context()
    context.set_default_timeout(PATIENCE_MS)
    asked = list[str]()

    def opened(url: str) -> Page:
        tab = context.new_page()
        tab.on("request", lambda request: asked.append(request.url))
        tab.goto(url)
        return tab

    yield opened
    assert asked
    assert [url for url in asked if ANNA in url or BEN in url] == []
    assert context.cookies() == []
    assert not any(ANNA in text or BEN in text for text in _kept(context.pages))
    context.close()


def _kept(pages: list[Page]) -> list[str]:
    """What outlives the tabs."""
    return [page.evaluate("JSON.stringify(localStorage)") for page in pages]


def let_in(page: Page, name: str) -> None:
    """The page is; where the machine is too busy for others to answer in time, it asks again."""

    def known() -> bool:
        expect(page.locator("input[name=token], input[name=author]")).to_be_visible()
        if page.locator("input[name=token]").count():
            page.reload()
            return False
        return True

    eventually(known)
    expect(page.get_by_label("You are")).to_have_value(name)


def test_a_new_tab_is_let_in_by_an_open_one_and_none_by_a_browser_that_was_closed(
    browser: Browser, service: Service, robot: FakeRobot
) -> None:
    with service.started(people=PEOPLE), tabs(browser) as tab:
        first = tab(service.url)
        unlock(first, ANNA)
        expect(first.locator(".proposal")).to_have_count(len(COMMANDS))
        second = tab(service.url)
        let_in(second, "anna")
        expect(second.locator(".proposal")).to_have_count(len(COMMANDS))
        second.keyboard.press("Escape")
        eventually(lambda: robot.heard)
        first.close()
        third = tab(f"{service.url}episodes.html")
        let_in(third, "anna")
        second.close()
        third.close()
        fourth = tab(service.url)
        expect(fourth.get_by_label("Token of this service")).to_be_visible()
    assert [said.author for said in robot.heard] == ["anna"]


def test_a_new_tab_takes_no_token_that_was_refused_and_none_of_two(
    browser: Browser, service: Service
) -> None:
    wanted = "Whoever steers robots here needs a token."
    with service.started(people=PEOPLE), tabs(browser) as tab:
        anna = tab(service.url)
        unlock(anna, ANNA)
        expect(anna.get_by_label("You are")).to_have_value("anna")
        wrong = tab(service.url)
        wrong.evaluate("sessionStorage.setItem('hld-token', 'x'.repeat(24))")
        wrong.reload()
        expect(wrong.get_by_role("alert")).to_contain_text(REFUSED)
        let_in(tab(service.url), "anna")
        unlock(wrong, BEN)
        expect(wrong.get_by_label("You are")).to_have_value("ben")
        expect(tab(service.url).get_by_role("alert")).to_have_text(wanted)


@pytest.mark.parametrize("name", ["episodes.html", "progress.html"])
def test_a_page_that_asks_now_and_then_is_locked_too(
    browser: Browser, service: Service, name: str
) -> None:
    with opened(browser) as page:
        page.clock.install()
        with service.started(people=PEOPLE):
            page.goto(service.url + name)
            unlock(page, ANNA)
            expect(page.get_by_label("You are")).to_have_value("anna")
        with service.started(people=WITHOUT_ANNA):
            page.clock.fast_forward(LATER_MS)
            locked(page)
            unlock(page, BEN)
            expect(page.get_by_label("You are")).to_have_value("ben")


def test_who_never_had_a_token_is_asked_for_one_where_one_is_needed_now(
    browser: Browser, service: Service
) -> None:
    with opened(browser) as page:
        with service.started():
            page.goto(service.url)
            expect(page.locator(".proposal")).to_have_count(len(COMMANDS))
        with service.started(people=PEOPLE):
            expect(page.get_by_role("alert")).to_have_text(
                "Whoever steers robots here needs a token."
            )
            page.goto(service.url + "docs")
            unlock(page, BEN)
            expect(page.locator(".route").first).to_be_visible()
