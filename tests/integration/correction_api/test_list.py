"""The list of episodes, one that is long in the player, and progress before anybody corrected."""

import re
from collections.abc import Iterator
from typing import NamedTuple

import httpx
import pytest
from playwright.sync_api import Browser, Page, Route, expect

from shared.messages.episode import Episode, Outcome
from shared.messages.policy import Version
from tests.integration.correction_api.browsing import DESK, PHONE, opened
from tests.integration.correction_api.fakes import COMMANDS
from tests.integration.correction_api.keeper import decide, kept, over
from tests.integration.correction_api.running import eventually

DECISIONS, HOLDS = 150, 15
"""Of an episode of 60 s: each command holds for so many decisions."""
SEGMENTS = """
async () => {
  const { segments } = await import("./account.js");
  const decided = (step, text, chosen_by) => ({ step, executed: { text }, chosen_by });
  const told = (id, author, step) => ({
    correction: { id, author, kind: "override", goal: { text: "wait" } },
    receipt: { accepted: true, step },
  });
  const decisions = [
    decided(0, "go", "1.0"), decided(20, "go", "1.0"), decided(40, "wait", "a"),
    decided(60, "wait", "b"), decided(80, "wait", "c"), decided(100, "wait", "1.0"),
  ];
  const corrections = [told("a", "ada", 30), told("b", "ada", 50), told("c", "bea", 70)];
  return segments(decisions, { corrections }, 120).map(({ from, to, by }) => [from, to, by]);
}
"""
SPIED = """
window.drawn = [];
const { prototype } = CanvasRenderingContext2D;
const { fillText } = prototype;
prototype.fillText = function (text, ...rest) {
  if (this.canvas.closest("[aria-label=Effort]")) window.drawn.push(String(text));
  return fillText.call(this, text, ...rest);
};
"""
"""What the curve of what people put in writes at its axes."""


class World(NamedTuple):
    """An API that tells of three episodes: one by 1.0, of which nobody said anything, one by 1.1
    that was corrected, and a long one."""

    api: httpx.Client
    quiet: Episode
    corrected: Episode
    long: Episode


@pytest.fixture(scope="module")
def world(tmp_path_factory: pytest.TempPathFactory) -> Iterator[World]:
    with kept(tmp_path_factory.mktemp("world")) as (api, robot):
        decide(robot, COMMANDS[:1] * 3)
        quiet = over(api, robot.end(corrections=0))
        robot.version = Version(1, 1)
        decide(robot, COMMANDS[:1] * 3)
        corrected = over(api, robot.end(Outcome.TIMEOUT))
        robot.deaf = True  # Its steps go on by its decisions alone.
        decide(robot, (COMMANDS[at // HOLDS % len(COMMANDS)] for at in range(DECISIONS)))
        for kind in ("pause", "resume"):
            told = {"kind": kind, "episode": robot.episode}
            said = api.post("api/v1/robots/robot-1/corrections", json=told).raise_for_status()
            path = f"api/v1/corrections/{said.json()['correction']['id']}"
            eventually(lambda path=path: api.get(path).json()["receipt"])
        yield World(api, quiet, corrected, over(api, robot.end(corrections=0)))


def fits(page: Page, size: tuple[int, int]) -> bool:
    return page.evaluate("document.documentElement.scrollWidth") <= size[0]


@pytest.mark.parametrize("size", [DESK, PHONE])
def test_the_list_is_filtered_and_a_reload_keeps_the_filters(
    browser: Browser, world: World, size: tuple[int, int]
) -> None:
    with opened(browser, world.api, size, "episodes.html") as page:
        rows = page.locator("tr[data-episode]")
        expect(rows).to_have_count(3)
        page.get_by_label("Success").select_option("false")
        expect(rows).to_have_count(1)
        expect(rows.first).to_have_attribute("data-episode", world.corrected.id)
        assert page.url.endswith("?success=false")
        page.reload()
        expect(rows).to_have_count(1)
        expect(page.get_by_label("Success")).to_have_value("false")
        page.get_by_label("Task").select_option("sandwich")
        page.get_by_label("Doubt").select_option("true")
        expect(page.locator(".lead")).to_have_text("No episode is like this.")
        page.get_by_role("button", name="All episodes").click()
        expect(rows).to_have_count(3)
        page.get_by_label("Version").select_option("1.1")
        expect(rows).to_have_count(2)
        expect(rows.last).to_have_attribute("data-episode", world.corrected.id)
        page.get_by_label("Corrected").select_option("true")
        expect(rows).to_have_count(1)
        page.get_by_label("Version").select_option("1.0")
        expect(page.locator(".lead")).to_have_text("No episode is like this.")
        page.get_by_label("Corrected").select_option("false")
        expect(rows).to_have_count(1)
        expect(rows.first).to_have_attribute("data-episode", world.quiet.id)
        assert page.url.endswith("?version=1.0&corrected=false")
        assert fits(page, size)
        rows.first.get_by_role("link").click()
        expect(page).to_have_url(re.compile(f"episode.html\\?id={world.quiet.id}$"))
        expect(page.get_by_role("heading", name="make a sandwich")).to_be_visible()


def test_the_commands_of_a_long_episode_can_be_read_and_its_freeze_is_over(
    browser: Browser, world: World
) -> None:
    with opened(browser, world.api, path=f"episode.html?id={world.long.id}") as page:
        expect(page.get_by_role("slider")).to_have_attribute("aria-valuemax", str(DECISIONS - 1))
        words = page.locator(".timeline .command text").all_text_contents()
        expected = [COMMANDS[at % len(COMMANDS)] for at in range(DECISIONS // HOLDS)]
        assert len(words) == len(expected)
        for text, command in zip(words, expected, strict=True):
            assert command.startswith(text.removesuffix("…"))
            assert len(text) >= min(len(command), 10)
        states = page.locator("tr[data-correction] .state")
        last = world.long.steps
        expect(states).to_have_text([f"stood still at step {last}", f"heard at step {last}"])
        assert page.evaluate(SEGMENTS) == [
            [0, 30, "1.0"],
            [30, 70, "a"],
            [70, 100, "c"],
            [100, 120, "1.0"],
        ]


def test_where_nobody_corrected_yet_the_curve_of_what_people_put_in_goes_to_one(
    browser: Browser, world: World
) -> None:
    def untouched(route: Route) -> None:
        told = route.fetch().json()  # The freeze of the long episode counts, too.
        versions = [one | {"corrections": 0, "human_s": 0.0} for one in told["versions"]]
        route.fulfill(json=told | {"versions": versions})

    with opened(browser, world.api, path="progress.html") as page:
        page.add_init_script(SPIED)
        page.route("**/api/v1/progress", untouched)
        page.reload()
        effort = page.get_by_role("region", name="Effort")
        expect(effort.locator("canvas")).to_have_count(1)
        page.wait_for_function("drawn.includes('1.1')")
        ticks = [float(text) for text in page.evaluate("drawn") if re.fullmatch(r"[\d.e-]+", text)]
        assert len(set(ticks)) > 3
        assert all(0 <= tick == round(tick, 2) for tick in ticks)
