"""A service that hangs, or a network that is gone: the page says so, and a freeze is not lost."""

import re

from playwright.sync_api import Browser, WebSocketRoute, expect

from tests.integration.correction_api.browsing import line
from tests.integration.correction_api.processes import Cell
from tests.integration.correction_api.running import eventually
from tests.integration.correction_api.test_access import at_work
from tests.integration.correction_api.visiting import visited

GREY = re.compile(r"grayscale")


def test_a_service_that_hangs_is_said_to_and_a_freeze_gets_through_when_it_is_back(
    browser: Browser, cell: Cell
) -> None:
    with visited(browser, cell.url, outage=True) as page:
        at_work(page)
        with cell.hanging():
            page.keyboard.press("Escape")
            expect(line(page)).to_have_text(
                re.compile(r"freeze, robot-1: the service does not answer; trying again, for \d+ s")
            )
            expect(page.locator(".banner")).to_contain_text(
                re.compile(r"Nothing heard from the service for \d+ s: what you see is old")
            )
            expect(page.locator("canvas.drawn").first).to_have_css("filter", GREY)
        expect(line(page)).to_contain_text("freeze, robot-1: in force since step")
        expect(page.locator(".banner")).to_have_count(0)
        expect(page.locator("canvas.drawn").first).to_have_css("filter", "none")
        paused = [view for view in cell.said() if view["correction"]["kind"] == "pause"]
        assert len(paused) == 1
        expect(page.locator(".stopped")).to_be_visible()
        page.keyboard.press("c")
        expect(line(page)).to_contain_text("carry on, robot-1: heard at step")


def test_a_connection_on_which_nothing_comes_any_more_is_made_anew(
    browser: Browser, cell: Cell
) -> None:
    with visited(browser, cell.url, outage=True) as page:
        made = list[WebSocketRoute]()

        def pass_on(socket: WebSocketRoute) -> None:
            made.append(socket)
            server = socket.connect_to_server()
            dead = len(made) == 1
            server.on_message(lambda message: None if dead and deaf else socket.send(message))

        deaf = list[bool]()
        page.route_web_socket("**/live", pass_on)
        page.reload()
        at_work(page)
        deaf.append(True)
        expect(page.locator(".banner")).to_contain_text("Nothing heard from the service")
        eventually(lambda: page.wait_for_timeout(100) or len(made) > 1)
        expect(page.locator(".banner")).to_have_count(0)
