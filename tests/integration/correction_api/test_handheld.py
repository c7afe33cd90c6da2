"""What a person sees of the live page on a phone, upright and sideways."""

import httpx
import pytest
from playwright.sync_api import Browser, expect

from tests.integration.correction_api.browsing import PHONE, SIDEWAYS, focused, said
from tests.integration.correction_api.crowded import UNCOVERED, WITHIN, desk

TOPS = "links => new Set(links.map(link => link.getBoundingClientRect().top)).size"
"""In how many rows some elements stand."""


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
        expect(page.get_by_role("button", name="pick up the saucer in force")).to_be_visible()
        expect(page.locator(".proposal.in-force span")).to_have_css("font-weight", "650")


@pytest.mark.parametrize("size", [(360, 640), (375, 553), (320, 256)])
def test_on_a_narrow_phone_or_at_four_times_the_size_all_can_be_read_and_the_stops_stay(
    browser: Browser, crowd: httpx.Client, size: tuple[int, int]
) -> None:
    with desk(browser, crowd, size) as page:
        stops = [".freeze-all", ".verdicts .freeze"]
        wanted = [".title h2", ".prompt", ".pictures", ".caption q", ".said li:last-child .what"]
        for one in (*page.locator(".proposal").all(), *map(page.locator, wanted)):
            one.first.scroll_into_view_if_needed()
            assert one.first.evaluate(UNCOVERED)
            assert [page.locator(stop).evaluate(UNCOVERED) for stop in stops] == [True] * 2
        assert page.locator(".head .pages a").evaluate_all(TOPS) == 1
        assert page.locator(".rail").evaluate("it => it.clientWidth >= innerWidth - 20")
        assert page.evaluate("document.documentElement.scrollWidth") <= size[0]


def test_on_a_phone_with_bars_two_proposals_and_both_stops_are_in_view_before_one_scrolls(
    browser: Browser, crowd: httpx.Client
) -> None:
    with desk(browser, crowd, (PHONE[0], 664)) as page:
        page.locator(".pictures canvas.angle.drawn").wait_for()
        assert page.evaluate("scrollY") == 0
        seen = [".title", ".pictures", ".caption", ".freeze-all", ".verdicts .freeze", ".line"]
        assert [page.locator(one).evaluate(UNCOVERED) for one in seen] == [True] * len(seen)
        for choice in page.locator(".proposal").all()[:2]:
            assert choice.evaluate(UNCOVERED)


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
