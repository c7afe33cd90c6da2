"""For everybody: by keyboard alone, with a screen reader, without motion, on a phone in the hand.

axe-core looks at every page in every state that a person can bring it into; robots are real.
"""

import hashlib
import re
from collections.abc import Callable, Iterator
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.browsing import DESK, PHONE, SIDEWAYS, line, take_proposal
from tests.integration.correction_api.fakes import FakeRobot
from tests.integration.correction_api.processes import Cell
from tests.integration.correction_api.running import eventually, running
from tests.integration.correction_api.visiting import FINGERS, visited

AXE = (Path(__file__).parents[2] / "vendor" / "axe.js").read_text()
PAGES = sorted(
    entry.name
    for entry in files("services.correction_api.page").iterdir()
    if entry.name.endswith(".html") and entry.name != "index.html"
)
SIZES = {"desk": (DESK, {}), "phone": (PHONE, FINGERS), "sideways": (SIDEWAYS, FINGERS)}
LIVE_REGIONS = "[aria-live]:not([aria-live=off]), [role=status], [role=alert], [role=log], output"
TARGET_PX = 44
WALKS = ("first", "second", "third")
"""A last word of a robot that was just told to stand still may change what is there in one."""
DRAWN_WITHIN_MS = 150_000  # The process that draws starts now, and others go first.

VISIBLE = """
element => element.checkVisibility({ visibilityProperty: true }) && element.getClientRects().length
"""
MISSED = f"""
walk => [...document.querySelectorAll("a[href], button, input, select, textarea, summary")]
  .filter(element => !element.disabled && !element.closest("[inert]") && ({VISIBLE})(element))
  .filter(element => element.dataset.walk !== walk)
  .map(element => element.outerHTML.slice(0, 120))
"""
REACHED = """
walk => {
  const element = document.activeElement;
  if (!element || element === document.body) return null;
  const again = element.dataset.walk === walk;
  element.dataset.walk = walk;
  const { outlineStyle, outlineWidth, boxShadow } = getComputedStyle(element);
  const visible = (outlineStyle !== "none" && outlineWidth !== "0px") || boxShadow !== "none";
  return { again, visible, html: element.outerHTML.slice(0, 120) };
}
"""
MOVING = """
() => [
  ...document.getAnimations()
    .filter(({ effect }) => effect.getComputedTiming().activeDuration > 20)
    .map(({ effect }) => `animation of ${effect.target?.className}`),
  ...[...document.querySelectorAll("*")]
    .filter(element => {
      const { transitionDuration, scrollBehavior } = getComputedStyle(element);
      const long = transitionDuration.split(",").some(text => parseFloat(text) > 0.02);
      return long || scrollBehavior === "smooth";
    })
    .map(element => `transition of ${element.tagName}.${element.className}`),
]
"""


def violations(page: Page) -> list[str]:
    """What axe finds, best practice included: the rule, and where."""
    page.evaluate(AXE)
    found = page.evaluate("axe.run(document, { resultTypes: ['violations'] })")["violations"]
    return [f"{one['id']}: {node['html'][:160]}" for one in found for node in one["nodes"]]


def hushed(page: Page) -> list[str]:
    """Live regions beyond the one that may speak."""
    told = page.locator(LIVE_REGIONS)
    return [told.nth(at).evaluate("it => it.outerHTML") for at in range(1, told.count())]


@pytest.fixture
def still(cell: Cell) -> Iterator[Cell]:
    """Both robots stand still, so that nothing comes and goes while a test looks."""
    for robot in cell.robots:
        cell.correct(robot, kind="pause")
    yield cell
    for robot in cell.robots:
        cell.http.post(f"api/v1/robots/{robot}/corrections", json={"kind": "resume"})


def at_work(page: Page) -> None:
    """The live page, once it shows a robot and what one can say to it."""
    expect(page.locator("canvas.drawn").first).to_be_visible(timeout=DRAWN_WITHIN_MS)
    expect(page.locator(".proposal").first).to_be_visible()


def spoken(page: Page) -> None:
    take_proposal(page)


def typed(page: Page) -> None:
    page.locator("input[name=words]").first.fill("give the cheese a kiss")
    page.wait_for_timeout(500)  # Its list follows the letters; axe sees whichever is there.


def keys_shown(page: Page) -> None:
    page.keyboard.press("?")
    expect(page.get_by_role("dialog")).to_be_visible()


def key_taken(page: Page) -> None:
    """A key is waited for, and the one that was pressed is another action's."""
    keys_shown(page)
    page.get_by_role("button", name="Key for: That is right").click()
    button = page.get_by_role("button", name="Key for: That is right, press a key …")
    expect(button).to_have_text("press a key …")
    expect(page.get_by_role("dialog").get_by_role("status")).to_contain_text("Press a key for")
    page.keyboard.press("r")
    expect(page.get_by_role("dialog").get_by_role("status")).to_contain_text("r is taken")


STATES: dict[str, Callable[[Page], None]] = {
    "as it comes": at_work,
    "something was said": spoken,
    "something is typed": typed,
    "the keys are shown": keys_shown,
    "a key is taken": key_taken,
}


@pytest.mark.parametrize("size", SIZES)
def test_axe_finds_nothing_on_the_live_page_whatever_state_it_is_in(
    browser: Browser, still: Cell, size: str
) -> None:
    found: dict[str, list[str]] = {}
    for state, bring in STATES.items():
        (width, height), options = SIZES[size]
        with visited(browser, still.url, (width, height), **options) as page:
            at_work(page)
            bring(page)
            found[state] = violations(page) + [f"speaks, too: {html}" for html in hushed(page)]
    assert found == {state: [] for state in STATES}


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", PAGES)
def test_axe_finds_nothing_on_the_other_pages(
    browser: Browser, cell: Cell, name: str, size: str
) -> None:
    (width, height), options = SIZES[size]
    with visited(browser, cell.url + name, (width, height), **options) as page:
        expect(page.get_by_role("heading").first).to_be_visible()
        page.wait_for_load_state("networkidle")
        assert violations(page) + hushed(page) == []
        assert page.evaluate("document.documentElement.scrollWidth") <= width


def test_every_control_is_reached_by_tab_and_shows_that_it_is(
    browser: Browser, still: Cell
) -> None:
    with visited(browser, still.url) as page:
        at_work(page)
        for walk in WALKS:
            reached = walked(page, walk)
            if not (missed := page.evaluate(MISSED, walk)):
                break
        assert missed == []
        assert len(reached) > 10
        assert [seen["html"] for seen in reached if not seen["visible"]] == []


def walked(page: Page, walk: str) -> list[dict[str, Any]]:
    """What has the focus, Tab by Tab, until it comes round."""
    reached: list[dict[str, Any]] = []
    page.keyboard.press("Tab")
    while (seen := page.evaluate(REACHED, walk)) and not seen["again"]:
        reached.append(seen)
        page.keyboard.press("Tab")
    return reached


def test_a_person_without_a_mouse_corrects_in_their_own_words_and_by_a_proposal(
    browser: Browser, cell: Cell
) -> None:
    with visited(browser, cell.url) as page:
        at_work(page)
        page.keyboard.press("/")
        page.keyboard.type("wait")
        page.keyboard.press("Enter")
        expect(line(page)).to_contain_text(re.compile("“wait”.* in force since step"))

        def enter(button: Locator) -> None:
            button.focus()
            page.keyboard.press("Enter")

        words = take_proposal(page, enter)
        eventually(lambda: cell.said()[0]["correction"]["goal"]["text"] == words)
        page.keyboard.press("Escape")
        eventually(lambda: cell.said()[0]["correction"]["kind"] == "pause")
        cell.correct(kind="resume")


def test_nothing_moves_for_who_wants_no_motion(browser: Browser, cell: Cell) -> None:
    with visited(browser, cell.url, reduced_motion="reduce") as page:
        at_work(page)
        spoken(page)
        assert page.evaluate(MOVING) == []
        page.keyboard.press("?")
        assert page.evaluate(MOVING) == []


def test_a_phone_in_the_hand_is_enough_to_correct(browser: Browser, cell: Cell) -> None:
    with visited(browser, cell.url, PHONE, **FINGERS) as page:
        expect(page.get_by_role("status")).to_have_count(1)  # There before anything is read out.
        at_work(page)
        assert page.evaluate("document.documentElement.scrollWidth") <= PHONE[0]
        words = take_proposal(page, Locator.tap)
        eventually(lambda: cell.said()[0]["correction"]["goal"]["text"] == words)
        small = [
            (button.inner_text(), box["width"], box["height"])
            for button in page.locator(".proposal, .verdicts button, button.say, .tile").all()
            if (box := button.bounding_box()) and min(box["width"], box["height"]) < TARGET_PX
        ]
        assert small == []


def test_the_form_that_asks_for_a_token_is_for_everybody_too(
    browser: Browser, router: MemoryRouter, robot: FakeRobot, tmp_path: Path
) -> None:
    del robot  # It only has to be there.
    with MemoryBus(router) as bus, running(bus, tmp_path, token="0123456789abcdef") as api:
        with visited(browser, str(api.base_url), outage=True) as page:
            field = page.get_by_label("Token of this service")
            expect(field).to_be_visible()
            assert violations(page) == []
            page.keyboard.press("Tab")
            assert page.evaluate("document.activeElement.name") == "token"


def test_what_tests_use_of_others_is_what_was_published() -> None:
    folder = Path(__file__).parents[2] / "vendor"
    table = (folder / "README.md").read_text()
    assert hashlib.sha256((folder / "axe.js").read_bytes()).hexdigest() in table
