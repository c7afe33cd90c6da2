"""Pages as a test's person visits them: by desk or phone, watched while they are used."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any
from urllib.parse import urlsplit

from playwright.sync_api import Browser, Locator, Page

from tests.integration.correction_api.browsing import DESK, PATIENCE_MS

TOLD = ("responded with a status of 503", "responded with a status of 409")
"""A browser says so whenever a learner is asked that isn't there, and when a robot refuses: it may
propose itself what can't be done. The page tells both to its person."""
FINGERS = {"has_touch": True, "is_mobile": True, "device_scale_factor": 2}


@contextmanager
def visited(
    browser: Browser,
    url: str,
    size: tuple[int, int] = DESK,
    *,
    outage: bool = False,
    **options: Any,
) -> Iterator[Page]:
    """A page of the service; it must not complain, nor ask anybody but its own origin.

    outage: the service goes away meanwhile, of which a browser always complains.
    options: of the browser's context, such as `color_scheme`.
    """
    context = browser.new_context(viewport={"width": size[0], "height": size[1]}, **options)
    page = context.new_page()
    page.set_default_timeout(PATIENCE_MS)
    complaints, asked = list[str](), list[str]()
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("console", lambda message: complaints.append(message.text))
    page.on("request", lambda request: asked.append(request.url))
    page.on("websocket", lambda socket: asked.append(socket.url))
    page.goto(url)
    yield page
    context.close()
    if not outage:
        complaints = [one for one in complaints if not any(why in one for why in TOLD)]
        assert not complaints, complaints
    asked = [one for one in asked if not one.startswith("blob:")]  # Pictures that are here already.
    assert {urlsplit(one).netloc for one in asked} == {urlsplit(url).netloc}
    if not outage:
        folder = urlsplit(url).path.rpartition("/")[0]
        assert all(urlsplit(one).path.startswith(f"{folder}/") for one in asked)


class Fingers:
    """On the glass, as the browser gets them from a screen; each is at a place of the page, px."""

    def __init__(self, page: Page) -> None:
        self._glass = page.context.new_cdp_session(page)

    def press(self, *places: tuple[float, float]) -> None:
        self._touch("touchStart", places)

    def move(self, *places: tuple[float, float]) -> None:
        self._touch("touchMove", places)

    def lift(self) -> None:
        self._touch("touchEnd", ())

    def _touch(self, what: str, places: tuple[tuple[float, float], ...]) -> None:
        points = [{"x": x, "y": y, "id": at} for at, (x, y) in enumerate(places)]
        self._glass.send("Input.dispatchTouchEvent", {"type": what, "touchPoints": points})


def middle(element: Locator) -> tuple[float, float]:
    """Of an element, where a finger meets it."""
    box = element.bounding_box()
    assert box
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
