"""How the pages of afterwards look with data on them: to a screen reader, on a phone, and while one
judges a stretch."""

from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Browser, expect

from shared.messages.episode import Outcome
from shared.wire.codec import encode
from shared.wire.keys import robot_key
from tests.integration.correction_api.browsing import DESK, PHONE, drag_stretch, line, opened
from tests.integration.correction_api.fakes import COMMANDS, FLEET
from tests.integration.correction_api.keeper import attempt, kept
from tests.integration.correction_api.running import eventually
from tests.integration.correction_api.test_access import hushed, violations

SAID = "api/v1/robots/robot-1/corrections"


class World:
    """An API with an episode in which things were said and taken back, and its learner."""

    def __init__(self, api: httpx.Client, episode: str) -> None:
        self.api, self.page = api, f"episode.html?id={episode}"


@pytest.fixture(scope="module")
def world(tmp_path_factory: pytest.TempPathFactory) -> Iterator[World]:
    with kept(tmp_path_factory.mktemp("world")) as (api, robot):
        for text in ("wait", "pick up the bread"):
            said = {"kind": "override", "text": text, "author": "anna"}
            told = api.post(SAID, json=said).raise_for_status().json()
        back = {"kind": "retract", "target": told["correction"]["id"], "author": "anna"}
        api.post(SAID, json=back).raise_for_status()
        over = attempt(api, robot, Outcome.TIMEOUT, decisions=8)
        yield World(api, over.id)


@pytest.mark.parametrize("size", [DESK, PHONE])
def test_axe_finds_nothing_on_pages_with_episodes_and_things_said(
    browser: Browser, world: World, size: tuple[int, int]
) -> None:
    found = dict[str, list[str]]()
    for path, wanted in (
        ("episodes.html", "tr[data-episode]"),
        (world.page, "tr[data-correction]"),
        ("progress.html", "[data-round]"),
        ("figures.html", ".timeline"),
    ):
        with opened(browser, world.api, size, path) as page:
            expect(page.locator(wanted).first).to_be_visible()
            page.wait_for_load_state("networkidle")
            found[path] = violations(page) + hushed(page)
            assert page.evaluate("document.documentElement.scrollWidth") <= size[0]
    assert found == {path: [] for path in found}


def test_one_sees_the_pictures_of_the_stretch_that_one_judges_and_the_button_that_keeps_it(
    browser: Browser, world: World
) -> None:
    with opened(browser, world.api, DESK, world.page) as page:
        drag_stretch(page, 0.35, 0.75)
        form = page.get_by_role("form", name="This should have been")
        expect(form.get_by_role("button", name="Keep")).to_be_in_viewport(ratio=1)
        for still in page.locator("figure.still").all():
            expect(still).to_be_in_viewport(ratio=1)
        cursor = int(page.get_by_role("slider").get_attribute("aria-valuenow") or -1)
        first, end = (
            int(form.get_by_label(f"{at} step").input_value()) for at in ("from", "up to")
        )
        path = world.page.replace("episode.html?id=", "api/v1/episodes/")
        decisions = world.api.get(f"{path}/decisions").json()["decisions"]
        assert first <= decisions[cursor]["step"] < end


def test_on_a_phone_the_form_comes_into_view_when_a_stretch_was_dragged(
    browser: Browser, world: World
) -> None:
    with opened(browser, world.api, PHONE, world.page, has_touch=True) as page:
        drag_stretch(page, 0.35, 0.75)
        expect(page.get_by_label("the right command")).to_be_in_viewport(ratio=1)
        expect(page.get_by_role("button", name="Keep")).to_be_in_viewport(ratio=1)
        assert page.evaluate("document.documentElement.scrollWidth") <= PHONE[0]


def test_axe_finds_nothing_in_the_player_while_a_key_is_waited_for(
    browser: Browser, world: World
) -> None:
    with opened(browser, world.api, DESK, world.page) as page:
        page.locator("summary", has_text="Keys").click()
        page.get_by_role("button", name="Key for: One decision on, now .").click()
        button = page.get_by_role("button", name="Key for: One decision on, press a key …")
        expect(button).to_have_text("press a key …")
        assert violations(page) == []


def test_one_line_of_a_page_reads_out_what_changes_elsewhere_on_it(
    browser: Browser, world: World
) -> None:
    with opened(browser, world.api, DESK, "episodes.html") as page:
        page.get_by_label("Success").select_option("true")
        expect(line(page)).to_have_text("No episode is like this.")
        page.get_by_role("button", name="All episodes").click()
        expect(line(page)).to_have_text("1 episode, the newest first")
        assert hushed(page) == []
    with opened(browser, world.api, DESK, "figures.html") as page:
        page.get_by_label("your ε").fill("0.1")
        expect(line(page)).to_contain_text("(1 − 0.100)^10 = 34.9 %")
        page.get_by_label("asked every").fill("50")
        expect(line(page)).to_contain_text("A command that turns wrong stays in force")
        expect(line(page)).not_to_contain_text("34.9 %")
        assert hushed(page) == []
    with opened(browser, world.api, DESK, "progress.html") as page:
        form = page.get_by_role("form", name="Roll back")
        form.get_by_label("reason").fill("it drops the bread")
        form.get_by_role("button").click()
        expect(line(page)).to_have_text("Kept: roll back to version 1.0.")
        assert hushed(page) == []
    with opened(browser, world.api, DESK, world.page) as page:
        drag_stretch(page, 0.35, 0.75)
        page.locator("summary", has_text="Keys").click()
        page.get_by_role("button", name="Key for: One decision on, now .").click()
        page.keyboard.press("Tab")
        expect(line(page)).to_have_text("Tab is needed to move about in the page.")
        page.get_by_role("button", name="Freeze all").click()
        expect(line(page)).to_contain_text("robot-1 is frozen")
        page.keyboard.press("Escape")
        expect(line(page)).to_have_text("robot-1 is frozen")
        assert hushed(page) == []


@pytest.mark.parametrize("path", ["episodes.html", "progress.html", "figures.html", "docs.html"])
def test_all_robots_can_be_frozen_from_every_page(
    browser: Browser, world: World, path: str
) -> None:
    with opened(browser, world.api, DESK, path) as page:
        page.keyboard.press("Shift+Escape")
        expect(page.locator(".head .line")).to_have_text("robot-1 is frozen")
        page.get_by_role("button", name="Freeze all").click()
        expect(page.locator(".head .line")).to_have_text("robot-1 is frozen")


def test_what_was_taken_back_is_named_and_what_was_said_later_has_no_step_of_the_episode(
    browser: Browser, world: World
) -> None:
    name = world.page.rpartition("=")[2]
    told = world.api.get(f"api/v1/episodes/{name}").json()["corrections"][0]["correction"]
    late = {"kind": "retract", "target": told["id"], "author": "anna", "episode": name}
    world.api.post(SAID, json=late | {"begun_ns": told["begun_ns"] + 10**12}).raise_for_status()
    with opened(browser, world.api, DESK, world.page) as page:
        rows = page.locator(
            "tr[data-correction]", has=page.get_by_role("rowheader", name="taken back")
        )
        expect(rows.filter(has_text="of “pick up the bread”")).to_have_count(1)
        expect(rows.filter(has_text="of “wait”")).to_contain_text("after its end")


def test_the_player_tells_what_a_person_said_at_a_decision(
    browser: Browser, tmp_path: Path
) -> None:
    with kept(tmp_path) as (api, robot):
        robot.deaf = True  # It stands at its first decision until somebody has spoken.
        decision = robot.decide()
        robot.bus.ask(robot_key(FLEET, robot.name, "decision"), encode(decision), timeout_s=5)
        late = decision.time_ns + 2_000_000_000  # A robot in lockstep waits for so long.
        words = {"kind": "override", "text": "wait", "begun_ns": late}
        api.post(SAID, json=words).raise_for_status()
        (receipt,) = eventually(lambda: robot.receipts).values()
        robot.step, robot.deaf = robot.step + 20, False
        over = attempt(api, robot)
        with opened(browser, api, path=f"episode.html?id={over.id}") as page:
            told = page.locator(".moment .caption-of")
            expect(told.first.locator("q")).to_have_text(COMMANDS[0])
            expect(told.last).to_have_text("wait✎ what a person said instead, in force at once")
            steps = f"began {receipt.step}, in force {receipt.step}"
            expect(page.locator("tr[data-correction]")).to_contain_text(steps)
            page.keyboard.press(".")
            expect(told).to_have_count(1)
            expect(told.locator("q")).to_have_text("wait")


WORDS = """
boxes => boxes.map(box => {
  const text = box.querySelector("text");
  const end = text.x.baseVal[0].value + text.getComputedTextLength();
  return [text.textContent, end <= box.width.baseVal.value];
})
"""
"""What stands in some stretches of the timeline, and whether it ends before they do."""


@pytest.mark.parametrize("width", [1440, 1024, 700])
def test_the_words_in_the_timeline_end_where_their_stretch_does(
    browser: Browser, world: World, width: int
) -> None:
    with opened(browser, world.api, (width, 900), world.page) as page:
        stretches = page.locator(".timeline .command")
        expect(stretches.first).to_be_visible()
        told = stretches.evaluate_all(WORDS)
        assert any(words for words, _ in told)
        assert [words for words, fits in told if words and not fits] == []


def test_progress_says_which_option_measures_success(browser: Browser, world: World) -> None:
    with opened(browser, world.api, DESK, "progress.html") as page:
        brought = page.get_by_role("region", name="What rounds brought")
        expect(brought).to_contain_text("hld up --oracle --evaluate 60")
        expect(brought).to_contain_text("gate.trials.episodes")


def test_a_version_in_force_that_has_done_nothing_yet_is_in_the_table(
    browser: Browser, world: World
) -> None:
    with opened(browser, world.api, DESK, "progress.html") as page:
        rows = page.locator("tr[data-version]")
        expect(rows).to_have_count(2)
        expect(rows.first).to_contain_text("1.0")
        expect(rows.last).to_have_text("1.1 in forcenot evaluatedno episode yet0–0.0")


def test_before_the_first_episode_the_table_has_the_version_in_force(
    browser: Browser, tmp_path: Path
) -> None:
    with kept(tmp_path) as (api, _), opened(browser, api, DESK, "progress.html") as page:
        expect(page.get_by_text("No version has done anything yet.")).to_be_visible()
        expect(page.locator("tr[data-version]")).to_have_text(
            "1.1 in forcenot evaluatedno episode yet0–0.0"
        )


PAINTED = """
() => {
  return [...document.querySelectorAll(".curves canvas")].map(canvas => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    const near = (at, [r, g, b]) =>
      Math.abs(data[at] - r) + Math.abs(data[at + 1] - g) + Math.abs(data[at + 2] - b) < 24;
    const count = colour => {
      let count = 0;
      for (let at = 0; at < data.length; at += 4) count += data[at + 3] > 200 && near(at, colour);
      return count;
    };
    return { person: count([169, 61, 34]), warn: count([133, 81, 3]) };
  });
}
"""


def test_one_version_is_drawn_with_its_interval_and_the_seconds_of_people(
    browser: Browser, world: World
) -> None:
    with opened(browser, world.api, DESK, "progress.html") as page:
        expect(page.locator(".curves canvas")).to_have_count(2)
        expect(page.locator("tr[data-version='1.0']")).to_have_count(1)
        success, effort = page.evaluate(PAINTED)
        assert success["person"] > 200  # The interval of a single try: a long line.
        assert effort["warn"] > 20


def test_a_page_that_does_not_exist_leads_to_those_that_do(world: World) -> None:
    answer = world.api.get("nothing.html")
    assert answer.status_code == 404
    assert answer.headers["content-type"].startswith("text/html")
    assert 'href="episodes.html"' in answer.text
    assert (
        world.api.get("api/v1/nothing.html")
        .headers["content-type"]
        .startswith("application/problem+json")
    )
