"""What a person sees of the live page without looking for it, with as much on it as real robots
bring: eleven proposals, many things said, two versions measured."""

from collections.abc import Iterator
from contextlib import contextmanager

import httpx
import pytest
from playwright.sync_api import Browser, Page, expect

from shared.messages.episode import Outcome
from shared.messages.policy import Version
from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.browsing import (
    DESK,
    PHONE,
    SIDEWAYS,
    TABLET,
    focused,
    line,
    opened,
    said,
)
from tests.integration.correction_api.crowded import LONG, CrowdedRobot
from tests.integration.correction_api.fakes import FakeLearner
from tests.integration.correction_api.running import eventually, running

MUTE = "delete Navigator.prototype.mediaDevices"
WITHIN = """
elements => elements.filter(element => {
  const box = element.getBoundingClientRect();
  const list = element.closest("ol")?.getBoundingClientRect() ?? { top: 0, bottom: innerHeight };
  const [top, bottom] = [Math.max(0, list.top), Math.min(innerHeight, list.bottom)];
  return box.height > 0 && box.top >= top - 1 && box.bottom <= bottom + 1;
}).length
"""
"""How many of some elements lie wholly in the window, and in the list that they stand in."""
CROOKED = """
() => [...document.querySelectorAll("button, select, kbd")].filter(element => {
  const box = element.getBoundingClientRect();
  const around = element.tagName === "KBD" && element.closest("button")?.getBoundingClientRect();
  const out = around && (box.right > around.right || box.bottom > around.bottom);
  return box.width && (out || element.scrollWidth > element.clientWidth + 1);
}).map(element => element.outerHTML)
"""
"""Whose text doesn't fit, or runs out of its button."""
UNCOVERED = """
element => {
  const { left, top, right, bottom } = element.getBoundingClientRect();
  const lies = (x, y) => element.contains(document.elementFromPoint(x, y));
  return [left + 9, right - 9].every(x => lies(x, top + 3) && lies(x, bottom - 3));
}
"""
"""Whether an element is in the window and nothing lies over it."""


@pytest.fixture(scope="module")
def crowd(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    """An API that has heard of three such robots and a learner, and of what was said to one."""
    router = MemoryRouter()
    with MemoryBus(router) as bus, MemoryBus(router) as robots:
        fleet = [CrowdedRobot(robots, f"robot-{number}") for number in (1, 2, 3)]
        learner = FakeLearner(robots)
        with running(bus, tmp_path_factory.mktemp("api")) as api:
            eventually(lambda: len(api.get("api/v1/robots").json()["robots"]) == len(fleet))
            for robot, version in zip(fleet, (0, 1, 1), strict=True):
                robot.version = Version(1, version)
                robot.decide()
                robot.end(Outcome.SUCCESS)
                robot.decide()
            learner.announce("1.1")
            learner.beat()
            for text in LONG[:8]:
                told = {"kind": "override", "text": text, "author": "person"}
                api.post("api/v1/robots/robot-1/corrections", json=told).raise_for_status()
            yield api
        learner.close()
        for robot in fleet:
            robot.close()


@contextmanager
def desk(
    browser: Browser, api: httpx.Client, size: tuple[int, int], mute: bool = False
) -> Iterator[Page]:
    """The page with everything on it, and an answer in its line; mute: without a microphone."""
    with opened(browser, api, size, has_touch=size is PHONE) as page:
        if mute:
            page.add_init_script(MUTE)
            page.reload()
        expect(page.locator(".proposal")).to_have_count(9)
        expect(page.locator(".tile")).to_have_count(3)
        expect(said(page).nth(7)).to_be_attached()
        if size is DESK:
            expect(page.locator(".tally li")).to_have_count(2)
            expect(page.locator(".head .learner .facts")).to_be_visible()
        page.keyboard.press("y")
        expect(line(page)).to_contain_text("robot-1: heard")
        yield page


@pytest.mark.parametrize("mute", [False, True], ids=["talking", "mute"])
@pytest.mark.parametrize("size", [DESK, TABLET])
def test_all_proposals_the_line_and_three_things_said_are_seen_at_once(
    browser: Browser, crowd: httpx.Client, size: tuple[int, int], mute: bool
) -> None:
    with desk(browser, crowd, size, mute) as page:
        assert page.locator(".proposal").evaluate_all(WITHIN) == 9
        assert line(page).evaluate_all(WITHIN) == 1
        assert said(page).evaluate_all(WITHIN) >= 3
        assert page.locator(".verdicts button").evaluate_all(WITHIN) == 7
        assert page.evaluate("document.documentElement.scrollHeight") <= size[1]
        head = page.locator(".head").bounding_box()
        assert head
        assert head["height"] <= 54  # One row.


@pytest.mark.parametrize("size", [DESK, TABLET])
def test_a_long_refusal_covers_nothing_and_leaves_three_things_said(
    browser: Browser, crowd: httpx.Client, size: tuple[int, int]
) -> None:
    reason = "robot-1 holds the tomato already, and its low level knows no command for a second one"
    with desk(browser, crowd, size) as page:
        page.evaluate(
            "async text => (await import('./store.js')).tell(text, 'bad')",
            f"“put it down beside the cutting board”, robot-1: refused, since {reason}",
        )
        expect(line(page)).to_contain_text("second one")
        assert line(page).evaluate("it => it.scrollHeight <= it.clientHeight + 1")
        text, list_ = line(page).bounding_box(), page.locator(".said").bounding_box()
        assert text
        assert list_
        assert text["y"] + text["height"] <= list_["y"] + 1
        assert said(page).evaluate_all(WITHIN) >= 3


@pytest.mark.parametrize("mute", [False, True], ids=["talking", "mute"])
def test_on_a_phone_the_stops_and_the_robots_name_stay_while_one_scrolls_to_what_was_said(
    browser: Browser, crowd: httpx.Client, mute: bool
) -> None:
    with desk(browser, crowd, PHONE, mute) as page:
        always = [".freeze-all", ".verdicts .freeze", ".verdicts .whom", ".line"]
        last_proposal = page.locator(".proposal").nth(8)
        for wanted in (page.locator(".focus .title"), last_proposal, said(page).nth(2)):
            wanted.scroll_into_view_if_needed()
            assert [page.locator(one).evaluate_all(WITHIN) for one in always] == [1] * 4
        assert page.locator(".verdicts .whom").text_content() == "robot-1"
        page.evaluate("scrollTo(0, document.body.scrollHeight)")
        bar, last = page.locator(".hand").bounding_box(), said(page).last.bounding_box()
        assert bar
        assert last
        assert last["y"] + last["height"] <= bar["y"]
        assert said(page).evaluate_all(WITHIN) >= 3
        assert page.evaluate("document.documentElement.scrollWidth") <= PHONE[0]


@pytest.mark.parametrize("height", [PHONE[1], 664, 568], ids=["tall", "with bars", "small"])
def test_on_a_phone_one_sees_the_robot_and_both_stops_while_one_chooses(
    browser: Browser, crowd: httpx.Client, height: int
) -> None:
    with desk(browser, crowd, (PHONE[0], height)) as page:
        seen = [".pictures", ".caption", ".freeze-all", ".verdicts .freeze"]
        page.locator(".pictures canvas.angle.drawn").wait_for()
        for choice in page.locator(".proposal").all():
            choice.scroll_into_view_if_needed()
            assert choice.evaluate(UNCOVERED)
            assert [page.locator(one).evaluate(UNCOVERED) for one in seen] == [True] * 4


def test_on_a_phone_one_sees_the_robot_and_all_that_fits_while_one_types(
    browser: Browser, crowd: httpx.Client
) -> None:
    with desk(browser, crowd, PHONE) as page:
        page.locator("input[name=words]").tap()
        page.keyboard.type("pick")
        expect(page.locator("[role=option]").last).to_contain_text("nearest known")
        for option in page.locator("[role=option]").all():
            assert option.evaluate(UNCOVERED)
        assert page.locator(".pictures").evaluate(UNCOVERED)


@pytest.mark.parametrize("size", [SIDEWAYS, (667, 375)])
def test_a_phone_held_sideways_shows_the_robot_what_one_can_say_and_both_stops_at_once(
    browser: Browser, crowd: httpx.Client, size: tuple[int, int]
) -> None:
    with desk(browser, crowd, size) as page:
        seen = [".title h2", ".prompt", ".pictures", ".caption"]
        seen += [".freeze-all", ".verdicts .freeze", "[data-tile=robot-2]"]
        page.locator(".pictures canvas.angle.drawn").wait_for()
        for choice in page.locator(".proposal").all()[:4]:
            assert choice.evaluate(UNCOVERED)
        for wanted in (page.locator(".proposal").nth(8), said(page).last):
            wanted.scroll_into_view_if_needed()
            assert [page.locator(one).evaluate(UNCOVERED) for one in seen] == [True] * len(seen)
            assert wanted.evaluate(UNCOVERED)
        assert page.evaluate("document.documentElement.scrollWidth") <= size[0]
        assert page.evaluate("document.documentElement.scrollHeight") <= size[1]


@pytest.mark.parametrize("size", [DESK, (1280, 800), TABLET, PHONE, SIDEWAYS])
def test_no_text_runs_out_of_its_button(
    browser: Browser, crowd: httpx.Client, size: tuple[int, int]
) -> None:
    with desk(browser, crowd, size) as page:
        assert page.evaluate(CROOKED) == []
        page.keyboard.press("?")
        expect(page.get_by_role("dialog")).to_be_visible()
        assert page.evaluate(CROOKED) == []


def test_on_a_phone_one_sees_the_robot_that_one_goes_to_and_its_newest_commands(
    browser: Browser, crowd: httpx.Client
) -> None:
    with desk(browser, crowd, PHONE) as page:
        rail, focus = page.locator(".rail").bounding_box(), page.locator(".title").bounding_box()
        assert rail
        assert focus
        assert rail["y"] + rail["height"] <= focus["y"]
        course = page.locator(".course")
        assert course.evaluate("it => it.scrollLeft > 0")
        assert course.evaluate("it => it.scrollLeft + it.clientWidth >= it.scrollWidth - 1")
        page.evaluate("scrollTo(0, document.body.scrollHeight)")
        expect(page.locator(".focus h2")).not_to_be_in_viewport()
        page.keyboard.press("ArrowRight")
        expect(focused(page)).to_have_text("robot-2")
        expect(focused(page)).to_be_in_viewport(ratio=1)
        covered = page.locator(".you").bounding_box()
        title = focused(page).bounding_box()
        assert covered
        assert title
        assert title["y"] >= covered["y"] + covered["height"]
