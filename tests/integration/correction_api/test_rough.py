"""Rough conditions: a slow network, a service that is killed, a path prefix, a hostile network."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, expect

from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.fakes import FakeRobot
from tests.integration.correction_api.processes import Cell
from tests.integration.correction_api.running import eventually, running
from tests.integration.correction_api.test_access import PAGES, at_work
from tests.integration.correction_api.visiting import visited

SLOW = {"offline": False, "latency": 300, "downloadThroughput": 50_000, "uploadThroughput": 50_000}
"""400 kbit/s; what two cameras of a robot send is several times as much."""
STALE_STEPS = 50 * 20
"""Far more than a queue that doesn't grow can be behind, far less than one that grows."""

WATCH_LINE = """
() => {
  window.shown = [];
  const note = () => window.shown.push(document.querySelector("[role=status]")?.textContent ?? "");
  new MutationObserver(note).observe(document.body,
    { subtree: true, childList: true, characterData: true });
}
"""
ACCEPTED = re.compile(r"^“(.+?)”.*in force since step (\d+)")


def test_over_a_slow_network_pictures_are_dropped_and_words_are_obeyed(
    browser: Browser, cell: Cell
) -> None:
    with visited(browser, cell.url) as page:
        at_work(page)
        dropped = cell.figure('hldagger_live_dropped_total{kind="frame"}')
        session = page.context.new_cdp_session(page)
        session.send("Network.enable")
        session.send("Network.emulateNetworkConditions", SLOW)
        eventually(
            lambda: cell.figure('hldagger_live_dropped_total{kind="frame"}') > dropped + 20,
            within_s=120,
        )
        for text in ("pick up the cheese", "wait"):
            _say(page, text)
            eventually(lambda text=text: _newest(cell) == (text, "in force"), within_s=60)
            expect(page.get_by_role("status").first).to_contain_text("in force", timeout=60_000)
        assert cell.figure("hldagger_live_waiting") <= 40
        seen = int(page.locator("canvas.drawn").first.get_attribute("data-step") or 0)
        assert cell.http.get("api/v1/robots/robot-1").json()["step"] - seen < STALE_STEPS


def test_the_page_comes_back_after_a_kill_and_has_lost_nothing_that_it_showed_as_accepted(
    browser: Browser, cell: Cell
) -> None:
    with visited(browser, cell.url, outage=True) as page:
        at_work(page)
        page.evaluate(WATCH_LINE)
        for text in ("wait", "pick up the cheese", "pick up the tomato"):
            _say(page, text)
            shown = re.compile(f"^“{text}”.*in force since step")
            expect(page.get_by_role("status").first).to_have_text(shown)
        _say(page, "put it on the plate")  # Whether it is taken yet, nobody knows.
        cell.kill()
        expect(page.locator(".banner").first).to_be_visible()
        field = page.locator("input[name=words]").first
        field.fill("pick up the ham, gently")
        cell.restart()
        expect(page.locator(".banner")).to_have_count(0)
        expect(field).to_have_value("pick up the ham, gently")
        matches = [ACCEPTED.match(text) for text in page.evaluate("shown")]
        told = {match.groups() for match in matches if match}
        kept = {
            (view["correction"]["goal"]["text"], str(view["receipt"]["step"]))
            for view in cell.said()
            if view["receipt"] and view["receipt"]["accepted"] and view["correction"]["goal"]
        }
        assert len(told) >= 3
        assert told <= kept
        step = page.locator("canvas.drawn").first.get_attribute("data-step") or ""
        expect(page.locator("canvas.drawn").first).not_to_have_attribute("data-step", step)
        field.press("Enter")
        eventually(lambda: _newest(cell)[0] == "pick up the ham, gently")


@pytest.mark.parametrize("name", ["", "docs", *PAGES])
def test_all_pages_work_below_a_path_prefix_and_ask_nobody_else(
    browser: Browser, prefixed: str, name: str
) -> None:
    with visited(browser, prefixed + name) as page:
        expect(page.get_by_role("heading").first).to_be_visible()
        page.wait_for_load_state("networkidle")
        links = page.locator("a[href]").evaluate_all("links => links.map(link => link.href)")
        assert [link for link in links if not link.startswith(prefixed)] == []


def test_the_path_prefix_without_a_slash_leads_to_the_page(browser: Browser, prefixed: str) -> None:
    page = browser.new_page()
    page.goto(prefixed.rstrip("/"))
    expect(page).to_have_url(prefixed)
    expect(page.locator(".proposal").first).to_be_visible()
    page.close()


@pytest.mark.parametrize("name", ["", "docs", *PAGES])
def test_a_page_that_wanted_to_ask_somebody_else_could_not(
    browser: Browser, prefixed: str, name: str
) -> None:
    page = browser.new_page()
    page.goto(prefixed + name)
    assert _blocked(page, "http://127.0.0.1:9/")
    page.close()


@pytest.fixture(scope="module")
def prefixed(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Where a service with a path prefix has its pages."""
    router = MemoryRouter()
    with MemoryBus(router) as bus, MemoryBus(router) as robots:
        robot = FakeRobot(robots)
        folder: Path = tmp_path_factory.mktemp("prefixed")
        with running(bus, folder, prefix="/cell/7") as api:
            eventually(lambda: api.get("api/v1/robots").json()["robots"])
            robot.decide()
            yield str(api.base_url)
        robot.close()


def _say(page: Page, text: str) -> None:
    field = page.locator("input[name=words]").first
    field.fill(text)
    field.press("Enter")


def _newest(cell: Cell) -> tuple[str, str]:
    said: list[dict[str, Any]] = cell.said()
    if not said:
        return "", ""
    return (said[0]["correction"]["goal"] or {}).get("text", ""), said[0]["status"]


def _blocked(page: Page, url: str) -> bool:
    """The browser itself keeps the page from asking anybody else."""
    script = """url => new Promise(resume => {
      document.addEventListener("securitypolicyviolation", () => resume(true), { once: true });
      fetch(url).then(() => resume(false), () => setTimeout(() => resume(false), 500));
    })"""
    return bool(page.evaluate(script, url))
