"""A browser on the page, as a person has it: it must not complain, nor ask anybody else."""

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
from playwright.sync_api import (
    Browser,
    Error,
    Locator,
    Page,
    Playwright,
    expect,
    sync_playwright,
)

from deploy.system import find_browser
from tests.integration.correction_api.running import eventually

FLAGS = [
    "--no-sandbox",  # Tests may run as root in a container.
    "--disable-gpu",
    "--disable-dev-shm-usage",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
]
PATIENCE_MS = 30_000  # Far more than is needed, for machines that are busy.
DESK, TABLET, PHONE, SIDEWAYS = (1440, 900), (1024, 768), (390, 844), (844, 390)

ANSWERED = re.compile(r"^“(.+)”, \S+: (?:in force since step \d|refused, since )")
"""What a robot answers to a proposal: a real one may propose what can't be done."""
AGAIN = re.compile(r"^Proposal \d has just become|has no proposal \d$")
"""What the page says where a proposal changed under the finger, or went."""
OFFERED = """
buttons => buttons.map(({ firstElementChild: key, classList }) =>
  classList.contains("in-force") ? "" : key.nextElementSibling.textContent)
"""
NOTHING = ("", "no proposal")  # what OFFERED says of a place that offers none
DRAWN = "() => new Promise(requestAnimationFrame)"
TAKEN_WITHIN_S = 150.0


@contextmanager
def launched(path: Path | None = None) -> Iterator[Browser]:
    """Chromium, without a screen: Debian's, or what starts it at `path`."""
    expect.set_options(timeout=PATIENCE_MS)
    with sync_playwright() as playwright:
        browser = launch(playwright, path)
        yield browser
        browser.close()


def launch(playwright: Playwright, path: Path | None = None, *flags: str) -> Browser:
    """The same with flags of its own; whoever launches it closes it."""
    found = path or find_browser()
    assert found, "no browser: make setup SYSTEM=--browser"
    return playwright.chromium.launch(executable_path=found, args=[*FLAGS, *flags])


@contextmanager
def opened(
    browser: Browser,
    api: httpx.Client,
    size: tuple[int, int] = DESK,
    path: str = "",
    **options: Any,
) -> Iterator[Page]:
    """The page; it must not complain, nor ask anybody but its own origin."""
    page = browser.new_page(viewport={"width": size[0], "height": size[1]}, **options)
    page.set_default_timeout(PATIENCE_MS)
    complaints, asked = list[str](), list[str]()
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("console", lambda message: complaints.append(message.text))
    page.on("request", lambda request: asked.append(request.url))
    page.on("websocket", lambda socket: asked.append(socket.url.replace("ws:", "http:")))
    page.goto(str(api.base_url.join(path)))
    yield page
    page.close()
    assert complaints == [], complaints
    assert asked
    own = (str(api.base_url), f"blob:{str(api.base_url).rstrip('/')}")
    assert [url for url in asked if not url.startswith(own)] == []


def line(page: Page) -> Locator:
    """The one line that is read out."""
    return page.get_by_role("status")


def focused(page: Page) -> Locator:
    """The robot in focus."""
    return page.locator(".focus h2")


def said(page: Page) -> Locator:
    """What was said about the robot in focus, the newest first."""
    return page.locator(".said li")


def take_proposal(
    page: Page,
    act: Callable[[Locator], None] = Locator.click,
    fits: Callable[[str], bool] = lambda _: True,
) -> str:
    """Say a proposal of a robot that moves, as a person does: they read what stands there and take
    it, and read anew where it has just become something else.

    act: how a button is taken. fits: which words may be said; never those that are in force.
    Returns the words that were answered.
    """

    def attempt() -> str | None:
        offered = page.locator(".proposal").evaluate_all(OFFERED)
        fitting = (at for at, text in enumerate(offered) if text not in NOTHING and fits(text))
        at = next(fitting, None)
        if at is None:
            return None
        try:
            act(page.locator(".proposal").nth(at))
        except Error:  # There are fewer of them now, as in the next episode.
            return None
        page.evaluate(DRAWN)  # From now on the line is about this one.
        expect(line(page)).to_have_text(re.compile(f"{ANSWERED.pattern}|{AGAIN.pattern}"))
        answered = ANSWERED.match(line(page).inner_text())
        return answered[1] if answered else None

    return eventually(attempt, within_s=TAKEN_WITHIN_S) or ""


def drag_stretch(page: Page, begin: float, end: float) -> Locator:
    """Drag over a share of the player's timeline; the form that opens."""
    expect(page.locator("figure.still img")).to_have_count(2)
    box = page.locator(".timeline svg").first.bounding_box()
    assert box
    middle = box["y"] + 50
    page.mouse.move(box["x"] + begin * box["width"], middle)
    page.mouse.down()
    page.mouse.move(box["x"] + end * box["width"], middle, steps=5)
    page.mouse.up()
    form = page.get_by_role("form", name="This should have been")
    expect(form).to_be_visible()
    return form
