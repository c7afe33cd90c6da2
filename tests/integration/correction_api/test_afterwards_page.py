"""Afterwards as a person does it: find an episode, look at it, say what should have been."""

import json
import re
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Browser, Page, Route, expect

from shared.messages.episode import Outcome
from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.browsing import PHONE, drag_stretch, line, opened
from tests.integration.correction_api.fakes import COMMANDS, FakeLearner, FakeRobot
from tests.integration.correction_api.keeper import attempt, kept
from tests.integration.correction_api.running import eventually, running
from tests.integration.correction_api.visiting import visited


class World:
    """An API with two episodes, and the learner that has their decisions."""

    def __init__(self, api: httpx.Client, good: str, bad: str) -> None:
        self.api, self.good, self.bad = api, good, bad


@pytest.fixture(scope="module")
def world(tmp_path_factory: pytest.TempPathFactory) -> Iterator[World]:
    with kept(tmp_path_factory.mktemp("world")) as (api, robot):
        good = attempt(api, robot, decisions=4)
        bad = attempt(api, robot, Outcome.TIMEOUT, decisions=8)
        yield World(api, good.id, bad.id)


def fits(page: Page, size: tuple[int, int]) -> bool:
    return page.evaluate("document.documentElement.scrollWidth") <= size[0]


def account(world: World) -> list[dict[str, object]]:
    told = world.api.get(f"api/v1/episodes/{world.bad}").json()
    return [view["correction"] for view in told["corrections"]]


def test_a_stretch_is_dragged_and_relabelled_and_taken_back(browser: Browser, world: World) -> None:
    before = len(account(world))
    with opened(browser, world.api, path=f"episode.html?id={world.bad}") as page:
        timeline = page.get_by_role("slider")
        expect(timeline).to_have_attribute("aria-valuemax", "7")
        form = drag_stretch(page, 0.25, 0.55)
        first, end = (
            int(form.get_by_label(name).input_value()) for name in ("from step", "up to step")
        )
        assert 0 < first < end
        field, verdict = form.get_by_label("the right command"), form.locator(".verdict")
        field.fill("dance around")
        expect(verdict).to_contain_text("would be refused: the low level doesn't understand")
        field.fill("seize the yellow slice")
        expect(verdict).to_contain_text(f"new to the low level · taken for “{COMMANDS[0]}”")
        verdict.get_by_role("button").last.click()
        expect(field).to_have_value(COMMANDS[4])
        expect(verdict).to_have_text("known")
        field.fill(COMMANDS[2])
        form.get_by_role("button", name="Keep").click()
        kept = f"Kept for the learner, of steps {first} to {end}."
        expect(line(page)).to_have_text(kept)
        row = page.locator("tr[data-correction]").last
        expect(row).to_contain_text(
            f"relabelled{COMMANDS[2]}person{first} to {end}kept for the next"
        )
        drawn = page.locator("svg[data-said]")
        expect(drawn).to_have_count(1)
        said = account(world)[before]
        assert (said["kind"], said["first_step"], said["end_step"]) == ("relabel", first, end)
        row.get_by_role("button", name="Take back").click()
        expect(page.locator("tr.gone")).to_contain_text("taken back")
        expect(drawn).to_have_class(re.compile("gone"))
    assert [one["kind"] for one in account(world)[before:]] == ["relabel", "retract"]


def test_what_is_not_kept_is_told_in_the_form_and_said_once_however_often_it_is_sent(
    browser: Browser, world: World
) -> None:
    before = len(account(world))
    url = str(world.api.base_url.join(f"episode.html?id={world.bad}"))
    with visited(browser, url, outage=True) as page:
        form = drag_stretch(page, 0.25, 0.55)
        field, problem = form.get_by_label("the right command"), form.locator(".notice")
        field.fill("dance around")
        form.get_by_role("button", name="Keep").click()
        expect(problem).to_contain_text("dance around")
        expect(problem).to_be_in_viewport(ratio=1)
        field.fill(COMMANDS[1])
        page.route("**/corrections", _lost)
        form.get_by_role("button", name="Keep").click()
        expect(problem).to_contain_text("cannot be reached")
        page.unroute("**/corrections")
        form.get_by_role("button", name="Keep").click()
        expect(form).to_have_count(0)
    (said,) = account(world)[before:]
    assert said["goal"]["text"] == COMMANDS[1]


def _lost(route: Route) -> None:
    """It is kept, and the answer is lost."""
    route.fetch()
    route.abort()


def test_everything_in_the_player_goes_by_keys(browser: Browser, world: World) -> None:
    before = len(account(world))
    with opened(browser, world.api, PHONE, f"episode.html?id={world.bad}") as page:
        timeline = page.get_by_role("slider")
        expect(timeline).to_have_attribute("aria-valuenow", "0")
        for key, index in ((".", "1"), (".", "2"), (",", "1"), ("End", "7"), ("Home", "0")):
            page.keyboard.press(key)
            expect(timeline).to_have_attribute("aria-valuenow", index)
        page.keyboard.press("Space")
        expect(timeline).to_have_attribute("aria-valuenow", "7")
        expect(page.get_by_role("button", name="play")).to_have_attribute("aria-pressed", "false")
        page.keyboard.press("Home")
        page.keyboard.press(".")
        page.keyboard.press("[")
        page.keyboard.press(".")
        page.keyboard.press("]")
        field = page.get_by_label("the right command")
        expect(field).to_be_focused()
        page.keyboard.type("wait")
        page.keyboard.press("Enter")
        rows = page.locator("tr[data-correction]")
        expect(rows).to_have_count(before + 1)
        expect(rows.last).to_contain_text("kept for the next round")
        assert fits(page, PHONE)
    said = account(world)[before]
    decisions = world.api.get(f"api/v1/episodes/{world.bad}/decisions").json()["decisions"]
    assert (said["first_step"], said["end_step"]) == (decisions[1]["step"], decisions[3]["step"])


def test_the_keys_of_the_player_can_be_given_away_and_turned_off(
    browser: Browser, world: World
) -> None:
    with opened(browser, world.api, path=f"episode.html?id={world.bad}") as page:
        timeline = page.get_by_role("slider")
        expect(timeline).to_have_attribute("aria-valuenow", "0")
        page.locator("summary", has_text="Keys").click()
        page.get_by_role("button", name="Key for: One decision on, now .").click()
        page.keyboard.press("[")
        expect(line(page)).to_contain_text("[ is taken: it does “A stretch begins")
        page.keyboard.press("k")
        page.reload()
        expect(page.get_by_role("button", name="Step on")).to_contain_text("k")
        page.keyboard.press("k")
        expect(timeline).to_have_attribute("aria-valuenow", "1")
        altgr = {"key": "[", "ctrlKey": True, "altKey": True, "modifierAltGraph": True}
        page.evaluate(
            "(key) => document.body.dispatchEvent(new KeyboardEvent('keydown', "
            "{ ...key, bubbles: true }))",
            altgr,
        )
        expect(page.get_by_text("a stretch begins at step")).to_be_visible()
        page.locator("summary", has_text="Keys").click()
        page.get_by_label("Single keys act").uncheck()
        page.keyboard.press("k")
        page.get_by_role("button", name="Step on").click()
        expect(timeline).to_have_attribute("aria-valuenow", "2")
        page.get_by_role("button", name="Reset all").click()
        expect(page.get_by_role("button", name="Step on")).to_contain_text(".")


def test_progress_says_what_rounds_brought_and_a_person_decides(
    browser: Browser, world: World
) -> None:
    with opened(browser, world.api, path="progress.html") as page:
        expect(page.locator("[data-round='1'] q")).to_have_text(
            "14 corrections: 52 % → 71 %, n = 200 in the gate's paired episodes"
        )
        expect(page.locator(".curves canvas")).to_have_count(2)
        expect(page.locator("tr[data-version='1.0']")).to_contain_text("50 % (9 to 91), n = 2")
        rounds = page.get_by_role("region", name="Table of rounds")
        expect(rounds).to_contain_text("held out 3 labels, needs 20: not judged")
        page.get_by_label("You are").fill("Anna B")
        back = page.get_by_role("form", name="Roll back")
        back.get_by_role("button").click()
        expect(back.locator("input:invalid")).to_have_count(1)
        back.get_by_label("reason").fill("it drops the bread")
        back.get_by_role("button").click()
        decide = page.get_by_role("region", name="Decide about versions")
        expect(decide).to_contain_text("Kept: roll back to version 1.0.")
        promote = page.get_by_role("form", name="Promote")
        promote.get_by_label("reason").fill("a bad scene")
        promote.get_by_role("button").click()
        rows = page.locator("tr[data-ruling]")
        expect(rows).to_have_count(2)
        expect(rows.last).to_contain_text("anna-b")
        expect(rows.last).to_contain_text("it drops the bread")
        expect(rows.first).to_contain_text("promote round 2")
        expect(rows.first).to_contain_text("the learner has it")


def test_figures_are_measured_ones_and_sliders_reckon_beside_them(
    browser: Browser, world: World
) -> None:
    with opened(browser, world.api, PHONE, "figures.html") as page:
        horizon = page.get_by_role("region", name="Table of the horizon")
        expect(horizon.locator("tbody tr").last).to_have_text(
            "base140.55 (0.40 to 0.69), n = 400.72"
        )
        cell = page.get_by_role("region", name="Table for oracle").locator("tr", has_text="slow")
        expect(cell).to_contain_text("0.81 (0.73 to 0.87), n = 120; 10 queries")
        page.get_by_label("your ε").fill("0.05")
        page.get_by_label("your horizon T").fill("10")
        expect(page.locator(".reckoned").first).to_contain_text("(1 − 0.050)^10 = 59.9 %")
        page.get_by_label("asked every").fill("50")
        page.get_by_label("answers after").fill("50")
        expect(page.locator(".reckoned").last).to_contain_text("at most 2.00 s")
        assert fits(page, PHONE)
        page.get_by_role("link", name="The newest episode").click()
        expect(page.get_by_role("slider")).to_be_visible()


def test_a_measured_horizon_is_drawn_beside_one_of_your_own(
    browser: Browser, router: MemoryRouter, tmp_path: Path
) -> None:
    epsilon = {"value": 0.1, "n": 90, "interval": [0.05, 0.18]}
    row = {"success": 0.9, "n": 40, "interval": [0.77, 0.96], "epsilon": epsilon}
    row["expected"] = {"value": 0.81, "interval": [0.67, 0.9]}
    figures = {"sandwich": {"oracle": {"epsilon": epsilon, "lengths": {"2": row}}}}
    report = {"figures": figures, "command": "hld experiment horizon", "date": "d", "site": "lab"}
    (tmp_path / "horizon.json").write_text(json.dumps(report))
    with MemoryBus(router) as bus, running(bus, tmp_path, reports=tmp_path) as api:
        with opened(browser, api, path="figures.html") as page:
            table = page.get_by_role("region", name="Table of the horizon")
            expect(table.locator("tbody tr")).to_have_text("oracle20.90 (0.77 to 0.96), n = 400.81")
            horizon = page.get_by_role("region", name="Compounding error against horizon")
            expect(horizon.locator(".legend")).to_contain_text("(1 − ε)^T, ε = 0.100")
            expect(horizon.locator("canvas")).to_have_count(1)


def test_a_measured_replanning_interval_is_drawn_by_delay_with_what_it_costs(
    browser: Browser, router: MemoryRouter, tmp_path: Path
) -> None:
    often = {"success": 0.9, "n": 40, "interval": [0.77, 0.96], "steps": 500, "decisions": 49.6}
    seldom = {"success": 0.5, "n": 40, "interval": [0.35, 0.65], "steps": 800, "decisions": 8.2}
    figures = {"oracle": {"0": {"10": often, "100": seldom}, "50": {"100": seldom}}}
    report = {
        "figures": figures,
        "command": "hld experiment replanning",
        "date": "d",
        "site": "far",
    }
    (tmp_path / "replanning.json").write_text(json.dumps(report))
    with MemoryBus(router) as bus, running(bus, tmp_path, reports=tmp_path) as api:
        with opened(browser, api, path="figures.html") as page:
            table = page.get_by_role("region", name="Intervals and delays for oracle")
            expect(table.locator("tbody tr").first).to_have_text(
                "0 s0.90 (0.77 to 0.96), n = 40; 50 queries0.50 (0.35 to 0.65), n = 40; 8 queries"
            )
            expect(table.locator("tbody tr").last).to_contain_text("1 s–0.50")
            section = page.get_by_role("region", name="Replanning interval against delay and cost")
            expect(section.locator(".legend").first).to_contain_text("answers after 1 s")
            expect(section.locator("canvas")).to_have_count(1)


def test_the_player_of_a_running_episode_works_without_a_learner_and_below_a_prefix(
    browser: Browser, router: MemoryRouter, robot: FakeRobot, tmp_path: Path
) -> None:
    with MemoryBus(router) as bus, running(bus, tmp_path, prefix="/robots") as api:
        learner = FakeLearner(bus)
        robot.decide()
        eventually(lambda: api.get("api/v1/robots").json()["robots"])
        page = browser.new_page()
        page.goto(str(api.base_url.join(f"episode.html?id={robot.episode}")))
        why = "The learner is away, so there are no decisions"
        expect(page.locator(".notice")).to_contain_text(why)
        expect(page.get_by_role("heading", name="An episode that is not over yet")).to_be_visible()
        page.close()
        learner.close()
