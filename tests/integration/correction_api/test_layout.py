"""What a person sees of the live page without looking for it, at a desk."""

from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Browser, expect
from simplejpeg import decode_jpeg_header

from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.browsing import (
    DESK,
    PHONE,
    SIDEWAYS,
    TABLET,
    line,
    opened,
    said,
)
from tests.integration.correction_api.crowded import WITHIN, desk
from tests.integration.correction_api.fakes import COMMANDS, FakeRobot
from tests.integration.correction_api.running import eventually
from tests.screenshots import shoot

UPRIGHT = (768, 1024)  # A tablet.
LONG_NAME = "anna-magdalena-of-the-night-shift"

CROOKED = """
() => [...document.querySelectorAll("button, select, kbd")].filter(element => {
  const box = element.getBoundingClientRect();
  const around = element.tagName === "KBD" && element.closest("button")?.getBoundingClientRect();
  const out = around && (box.right > around.right || box.bottom > around.bottom);
  return box.width && (out || element.scrollWidth > element.clientWidth + 1);
}).map(element => element.outerHTML)
"""
"""Whose text doesn't fit, or runs out of its button."""
CROWD_HEAD = """
async () => {
  const { state, touch } = await import("./store.js");
  const counted = [["1.11", 124, 31], ["1.12", 128, 91]];
  const doubt = number => ({ robot: `robot-${number}`, reason: "entropy", doubt: 0.5, waits_s: 0 });
  const told = {
    learner: { presence: "online", state: "judging", progress: 0.4, version: "1.12",
      corrections: 113, outbox: 3 },
    tally: counted.map(([version, episodes, successes]) => ({ version, episodes, successes })),
    help: { asking: [...Array(12).keys()].map(doubt), suppressed: 0 },
  };
  for (const [name, value] of Object.entries(told)) {
    Object.defineProperty(state, name, { get: () => value, set: () => {} });
  }
  touch();
}
"""
"""Twelve robots in doubt, a learner at work, many episodes, whatever comes from the service."""
OVERLAPPING = """
() => {
  const parts = [".pages a", ".told", ".you button", ".you input", ".head h1 img"]
    .flatMap(one => [...document.querySelectorAll(one)])
    .map(element => ({ element, box: element.getBoundingClientRect() }));
  const apart = ({ box: one }, { box: other }) =>
    one.right <= other.left + 1 || other.right <= one.left + 1;
  return parts
    .filter(part => part.box.left < 0 || part.box.right > innerWidth ||
      parts.some(other => other !== part && !apart(part, other)))
    .map(({ element }) => element.outerHTML);
}
"""
"""What of the head lies over another part of it, or out of the window."""
TOLD = """
parts => parts.map(part => {
  const [box, line] = [part, part.parentElement].map(one => one.getBoundingClientRect());
  if (!line.height || box.top >= line.bottom) return null;
  const inside = box.left >= line.left && box.right <= line.right + 1 && box.bottom <= line.bottom;
  return inside ? part.textContent.replace(/\\s+/g, " ").trim() : `cut: ${part.textContent}`;
}).filter(text => text !== null)
"""
"""What parts of a line say that have room in it."""
MARKS = """
tile => {
  const around = tile.getBoundingClientRect();
  const whole = part => {
    const box = part.getBoundingClientRect();
    const within = box.left >= around.left && box.right <= around.right &&
      box.top >= around.top && box.bottom <= around.bottom;
    const [x, y] = [box.left + box.width / 2, box.top + box.height / 2];
    return within && part.contains(document.elementFromPoint(x, y));
  };
  return [...tile.querySelectorAll(".name b, .marks > *")]
    .map(part => whole(part) ? part.textContent.trim() : `cut: ${part.textContent}`);
}
"""
"""The name of a robot in its tile, and in what state it is."""


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


@pytest.mark.parametrize("size", [(1920, 1080), DESK, (1280, 800), TABLET, UPRIGHT, SIDEWAYS])
def test_nothing_of_the_head_is_cut_when_robots_are_in_doubt(
    browser: Browser, crowd: httpx.Client, size: tuple[int, int]
) -> None:
    newest, before = "with people: 1.12 71 %, n = 128", "· 1.11 25 %, n = 124"
    with desk(browser, crowd, size) as page:
        page.evaluate(CROWD_HEAD)
        expect(page.get_by_role("button", name="12 in doubt")).to_be_visible()
        assert page.evaluate(OVERLAPPING) == []
        assert page.evaluate("document.documentElement.scrollWidth") <= size[0]
        learner = page.locator(".learner > *").evaluate_all(TOLD)
        success = page.locator(".tally > li").evaluate_all(TOLD)
        assert not [text for text in learner + success if text.startswith("cut")]
        if size is TABLET:
            assert learner[:1] == ["learner judging"]
            assert success == [newest]
        elif size[0] > TABLET[0]:
            assert learner[:3] == ["learner judging", "", "version 1.12"]
            assert success == [newest, before]


@pytest.mark.parametrize("size", [(1920, 1080), DESK, (1280, 800), TABLET, SIDEWAYS, PHONE])
def test_the_field_for_ones_name_says_what_it_is(
    browser: Browser, crowd: httpx.Client, size: tuple[int, int]
) -> None:
    with desk(browser, crowd, size) as page:
        label, field = page.locator(".you label span"), page.get_by_label("You are")
        expect(label).to_have_text("You are")
        expect(label).to_be_in_viewport(ratio=1)
        told, typed = label.bounding_box(), field.bounding_box()
        assert told
        assert typed
        above = field.evaluate("it => parseFloat(getComputedStyle(it).paddingTop)")
        assert told["y"] + told["height"] <= typed["y"] + above + 3  # Not over what is typed.
        assert told["x"] + told["width"] <= typed["x"] + typed["width"]


def test_the_tiles_of_twelve_robots_say_in_what_state_each_is_at_any_size(
    browser: Browser, api: httpx.Client, robot: FakeRobot, router: MemoryRouter
) -> None:
    told = {"kind": "override", "text": COMMANDS[2]}
    with MemoryBus(router) as bus:
        fleet = [robot, *(FakeRobot(bus, f"robot-{number}") for number in range(2, 13))]
        eventually(lambda: len(api.get("api/v1/robots").json()["robots"]) == len(fleet))
        for one in fleet:
            one.decide()
        for number, author in ((2, "anna"), (5, LONG_NAME), (6, "anna")):
            route = f"api/v1/robots/robot-{number}/corrections"
            api.post(route, json=told | {"author": author}).raise_for_status()
        for number in (4, 5, 6):
            route = f"api/v1/robots/robot-{number}/corrections"
            api.post(route, json={"kind": "pause", "author": "bert"}).raise_for_status()
        for number in (3, 5, 12):
            fleet[number - 1].ask(doubt=0.5)
        marks = {
            "robot-1": ["acting"],
            "robot-2": ["acting", "✎ anna"],
            "robot-3": ["? in doubt 50 %"],
            "robot-4": ["frozen"],
            "robot-5": ["? in doubt 50 %", "frozen", f"✎ {LONG_NAME}"],
            "robot-6": ["frozen", "✎ anna"],
            "robot-12": ["? in doubt 50 %"],
        }
        for size in (DESK, (1280, 800), TABLET, UPRIGHT, PHONE, SIDEWAYS):
            with opened(browser, api, size, has_touch=size is PHONE) as page:
                expect(page.locator(".tile")).to_have_count(len(fleet))
                expect(page.locator(".tile .doubt")).to_have_count(3)
                expect(page.locator(".tile.frozen")).to_have_count(3)
                for name, states in marks.items():
                    tile = page.locator(f"[data-tile={name}]")
                    tile.scroll_into_view_if_needed()
                    assert tile.evaluate(MARKS) == [name, *states], size
        for one in fleet[1:]:
            one.close()


def test_screenshots_are_taken_at_four_sizes(
    browser: Browser, crowd: httpx.Client, tmp_path: Path
) -> None:
    with desk(browser, crowd, DESK) as page:
        shoot(page, "live", tmp_path, tmp_path / "beside")
    taken = {
        path.relative_to(tmp_path).as_posix(): decode_jpeg_header(path.read_bytes())[:2]
        for path in tmp_path.rglob("*.jpg")
    }
    assert taken == {
        "live.jpg": (900, 1440),
        "beside/live-1024x768.jpg": (768, 1024),
        "beside/live-390x844.jpg": (844, 390),
        "beside/live-844x390.jpg": (390, 844),
    }


@pytest.mark.parametrize("size", [DESK, (1280, 800), TABLET, UPRIGHT, PHONE, SIDEWAYS])
def test_no_text_runs_out_of_its_button(
    browser: Browser, crowd: httpx.Client, size: tuple[int, int]
) -> None:
    with desk(browser, crowd, size) as page:
        assert page.evaluate(CROOKED) == []
        page.keyboard.press("?")
        expect(page.get_by_role("dialog")).to_be_visible()
        assert page.evaluate(CROOKED) == []
