"""The timeline of an episode of a minute, larger: what is brief in it is read, and met exactly."""

from collections.abc import Iterator
from typing import NamedTuple

import pytest
from playwright.sync_api import Browser, FloatRect, Locator, Page, expect

from tests.integration.correction_api.browsing import DESK, DRAWN, PHONE, SIDEWAYS
from tests.integration.correction_api.fakes import COMMANDS
from tests.integration.correction_api.keeper import STEPS, decide, kept, over
from tests.integration.correction_api.test_access import TARGET_PX, hushed, violations
from tests.integration.correction_api.test_after_looks import WORDS
from tests.integration.correction_api.visiting import FINGERS, Fingers, middle, visited

DECISIONS, BRIEF = 150, 70
"""Of an episode of a minute: at one of its decisions another command was in force."""
COMMAND = COMMANDS[2]
NEAR_PX = 2.0
"""A view goes by whole pixels."""
NEAREST = 8
"""Presses of a key after which nothing gets larger, on a phone, too."""
LEFT = "() => document.querySelector('.zoom').scrollLeft"
WIDE = "() => document.querySelector('svg.rows').getBoundingClientRect().width"
SEEN = """
() => {
  const { left, right } = document.querySelector(".zoom").getBoundingClientRect();
  const at = document.querySelector(".cursor").getBoundingClientRect().left;
  return left <= at && at <= right;
}
"""
PLACES = "elements => elements.map(element => element.getBoundingClientRect().x)"
PLAYED = f"""
async (last) => {{
  const slider = document.querySelector(".timeline");
  const [unseen, views] = [[], new Set()];
  await new Promise(done => {{
    const look = () => {{
      const index = Number(slider.getAttribute("aria-valuenow"));
      views.add(({LEFT})());
      if (!({SEEN})()) unseen.push(index);
      if (index >= last) done();
    }};
    new MutationObserver(look).observe(slider, {{ attributeFilter: ["aria-valuenow"] }});
    document.querySelector(".controls [aria-pressed]").click();
  }});
  return [unseen, views.size];
}}
"""
"""Plays on to a decision: those whose cursor was out of view, and how many views there were."""


class World(NamedTuple):
    """Where the episode is told, which had so many steps; from `first` to `end` the brief command
    was in force."""

    url: str
    steps: int
    first: int
    end: int


@pytest.fixture(scope="module")
def world(tmp_path_factory: pytest.TempPathFactory) -> Iterator[World]:
    with kept(tmp_path_factory.mktemp("world")) as (api, robot):
        robot.deaf = True  # Its steps go on by its decisions alone.
        decide(robot, (COMMAND if at == BRIEF else COMMANDS[0] for at in range(DECISIONS)))
        episode = over(api, robot.end())
        path = f"api/v1/episodes/{episode.id}/decisions?first={BRIEF}"
        first = api.get(path).json()["decisions"][0]["step"]
        url = str(api.base_url.join(f"episode.html?id={episode.id}"))
        yield World(url, episode.steps, first, first + STEPS)


def brief(page: Page) -> Locator:
    """The brief command in the timeline; it has its words as its title, too."""
    return page.locator(".command", has_text=f"{COMMAND}, steps")


def stretch(page: Page) -> FloatRect:
    """Where that lies."""
    found = brief(page).locator("rect").bounding_box()
    assert found
    return found


def step_at(page: Page, world: World, x: float) -> float:
    """Which step lies at a place of the page."""
    drawn = page.locator("svg.rows").bounding_box()
    assert drawn
    return (x - drawn["x"]) / drawn["width"] * world.steps


def choose(page: Page) -> None:
    """Point at the brief command."""
    expect(brief(page)).to_be_visible()
    page.mouse.click(*middle(brief(page).locator("rect")))
    expect(page.get_by_role("slider").first).to_have_attribute("aria-valuenow", str(BRIEF))


def zoom(page: Page) -> None:
    """Point at the brief command, and make it as large as it gets."""
    choose(page)
    for _ in range(NEAREST):
        page.keyboard.press("+")
    expect(brief(page).locator("text")).to_have_text(COMMAND)


def drag(page: Page, begin: float, *ends: float) -> tuple[int, int]:
    """Drag over the timeline by mouse, between places of the page; the steps that it selects."""
    y = stretch(page)["y"] + 10
    page.mouse.move(begin, y)
    page.mouse.down()
    for end in ends:
        page.mouse.move(end, y, steps=4)
        page.evaluate(DRAWN)
    page.mouse.up()
    return selected(page)


def selected(page: Page) -> tuple[int, int]:
    form = page.get_by_role("form", name="This should have been")
    expect(form).to_be_visible()
    first, end = (form.get_by_label(f"{at} step").input_value() for at in ("from", "up to"))
    return int(first), int(end)


def test_the_words_of_a_single_decision_can_be_read_when_one_zooms_in(
    browser: Browser, world: World
) -> None:
    with visited(browser, world.url) as page:
        choose(page)
        text, whole = brief(page).locator("text"), page.evaluate(WIDE)
        expect(text).to_have_text("")
        for _ in range(NEAREST):
            page.get_by_role("button", name="Zoom in").click()
        expect(text).to_have_text(COMMAND)
        assert brief(page).evaluate_all(WORDS) == [[COMMAND, True]]
        at = stretch(page)
        assert 0 < at["x"] < at["x"] + at["width"] < DESK[0]
        pictures = page.locator(".timeline image")
        expect(pictures.nth(2)).to_be_attached()
        bars = page.locator(".bar").evaluate_all(PLACES)
        for place in (at["x"], *page.locator(".cursor, .timeline image").evaluate_all(PLACES)):
            assert min(abs(bar - place) for bar in bars) < NEAR_PX
        assert pictures.count() < 20  # No others than those in view are asked for.
        nearest = page.evaluate(WIDE)
        page.get_by_role("button", name="Zoom out").click()
        page.wait_for_function(f"wide => ({WIDE})() <= wide / 2", arg=nearest)
        page.get_by_role("button", name="The whole timeline").click()
        expect(text).to_have_text("")
        assert page.evaluate(WIDE) == whole


def test_the_keys_that_zoom_can_be_others(browser: Browser, world: World) -> None:
    with visited(browser, world.url) as page:
        zoom(page)
        nearest = page.evaluate(WIDE)
        page.keyboard.press("-")
        page.wait_for_function(f"wide => ({WIDE})() <= wide / 2", arg=nearest)
        page.keyboard.press("0")
        expect(brief(page).locator("text")).to_have_text("")
        page.locator("summary", has_text="Keys").click()
        page.get_by_role("button", name="Key for: Zoom in, now +").click()
        page.keyboard.press("z")
        expect(page.get_by_role("button", name="z Zoom in", exact=True)).to_be_visible()
        assert violations(page) == []
        page.keyboard.press("z")
        page.wait_for_function(f"wide => ({WIDE})() > wide / 16", arg=nearest)


def test_a_stretch_that_is_dragged_in_what_is_zoomed_is_met_to_the_step(
    browser: Browser, world: World
) -> None:
    with visited(browser, world.url) as page:
        zoom(page)
        at = stretch(page)
        assert drag(page, at["x"], at["x"] + at["width"]) == (world.first, world.end)
        page.keyboard.press("Escape")
        expect(page.get_by_role("form")).to_have_count(0)
        page.evaluate("scrollTo(0, 0)")  # It had gone to the form.
        at, before = stretch(page), page.evaluate(LEFT)
        beyond = DESK[0] - 5.0  # The view goes along where one drags beyond its edge.
        first, end = drag(page, at["x"], beyond - 20, beyond)
        assert page.evaluate(LEFT) > before
        assert (first, end) == (world.first, round(step_at(page, world, beyond)))


def test_the_cursor_stays_in_view_while_it_plays_and_goes_by_keys(
    browser: Browser, world: World
) -> None:
    with visited(browser, world.url) as page:
        zoom(page)
        page.get_by_label("speed").select_option("8")
        unseen, views = page.evaluate(PLAYED, BRIEF + 20)
        assert (unseen, views > 2) == ([], True)
        page.get_by_role("button", name="pause").click()
        slider = page.get_by_role("slider")
        for key, index in (("Home", 0), ("End", DECISIONS - 1), (",", DECISIONS - 2)):
            page.keyboard.press(key)
            expect(slider).to_have_attribute("aria-valuenow", str(index))
            assert page.evaluate(SEEN)
        page.evaluate("document.querySelector('.zoom').scrollLeft = 0")
        page.keyboard.press(".")
        expect(slider).to_have_attribute("aria-valuenow", str(DECISIONS - 1))
        assert page.evaluate(SEEN)


def test_a_wheel_with_ctrl_zooms_about_the_pointer_and_one_without_goes_along(
    browser: Browser, world: World
) -> None:
    with visited(browser, world.url) as page:
        choose(page)
        x, whole = round(stretch(page)["x"]), page.evaluate(WIDE)
        pointed = step_at(page, world, x)
        page.mouse.move(x, stretch(page)["y"] + 10)
        page.keyboard.down("Control")
        for _ in range(6):
            page.mouse.wheel(0, -100)
        page.keyboard.up("Control")
        page.wait_for_function(f"wide => ({WIDE})() > 7 * wide", arg=whole)
        assert abs(step_at(page, world, x) - pointed) < STEPS / 4
        before, wide = page.evaluate(LEFT), page.evaluate(WIDE)
        page.mouse.wheel(300, 0)
        page.wait_for_function(f"before => ({LEFT})() >= before + 299", arg=before)
        page.mouse.wheel(0, 100)
        page.wait_for_function("() => scrollY > 0")
        assert page.evaluate(WIDE) == wide


def test_on_a_phone_two_fingers_zoom_one_drags_and_all_that_is_touched_is_large_enough(
    browser: Browser, world: World
) -> None:
    with visited(browser, world.url, PHONE, **FINGERS) as page:
        expect(brief(page)).to_be_visible()
        fingers, y = Fingers(page), stretch(page)["y"] + 10
        whole, between = page.evaluate(WIDE), step_at(page, world, 180)
        fingers.press((150, y))
        fingers.press((150, y), (210, y))
        for wide in (40, 80, 140):
            fingers.move((180 - wide, y), (180 + wide, y))
        fingers.lift()
        page.wait_for_function(f"wide => ({WIDE})() > 4 * wide", arg=whole)
        drawn = page.evaluate(WIDE)
        assert abs(step_at(page, world, 180) - between) * drawn / world.steps < NEAR_PX
        expect(page.get_by_role("form")).to_have_count(0)
        page.get_by_label("Part of the timeline in view").fill("200")
        page.wait_for_function(f"() => ({LEFT})() === 200")
        small = [
            (button.inner_text(), box["width"], box["height"])
            for button in page.locator(".closer > *, .controls > button, .controls select").all()
            if (box := button.bounding_box()) and min(box["width"], box["height"]) < TARGET_PX
        ]
        assert small == []
        assert page.evaluate("document.documentElement.scrollWidth") <= PHONE[0]
        expected = tuple(round(step_at(page, world, x)) for x in (100, 250))
        fingers.press((100, y))
        for x in (150, 200, 250):
            fingers.move((x, y))
        page.evaluate(DRAWN)
        fingers.lift()
        assert selected(page) == expected


def test_what_is_in_the_middle_stays_there_when_a_phone_is_turned(
    browser: Browser, world: World
) -> None:
    with visited(browser, world.url, PHONE, **FINGERS) as page:
        zoom(page)
        page.wait_for_function(SEEN)
        before = step_at(page, world, PHONE[0] / 2)
        page.set_viewport_size({"width": SIDEWAYS[0], "height": SIDEWAYS[1]})
        page.wait_for_function(f"() => ({WIDE})() > 8 * {SIDEWAYS[0]}")
        page.wait_for_function(SEEN)
        assert abs(step_at(page, world, SIDEWAYS[0] / 2) - before) < STEPS / 4


@pytest.mark.parametrize(("size", "options"), [(DESK, {}), (PHONE, FINGERS)])
def test_axe_finds_nothing_in_what_is_zoomed(
    browser: Browser, world: World, size: tuple[int, int], options: dict[str, bool]
) -> None:
    with visited(browser, world.url, size, **options) as page:
        zoom(page)
        assert violations(page) + hushed(page) == []
