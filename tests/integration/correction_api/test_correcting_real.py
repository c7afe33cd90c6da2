"""Correcting a real robot on the page, from a proposal to the word that is taken back.

Its π_HL proposes nine commands with noise, some of them impossible in the scene, and decides anew
meanwhile, as no robot that is made up does.
"""

import re
from functools import partial

from playwright.sync_api import Browser, Locator, Page, expect

from tests.integration.correction_api.browsing import line, said, take_proposal
from tests.integration.correction_api.processes import Cell
from tests.integration.correction_api.running import eventually
from tests.integration.correction_api.test_access import at_work
from tests.integration.correction_api.visiting import visited

WORDS = "wait a moment, please"  # No command as it is, and possible in every scene.


def state(cell: Cell) -> str:
    return str(cell.http.get("api/v1/robots/robot-1").json()["state"])


def kinds(cell: Cell) -> list[str]:
    """What was said, the oldest first."""
    return [view["correction"]["kind"] for view in reversed(cell.said())]


def in_force(page: Page, what: str) -> None:
    expect(line(page)).to_have_text(
        re.compile(f"^{what}, robot-1: (in force since|heard at) step \\d+$")
    )


def possible(cell: Cell, text: str) -> bool:
    """Whether the scene allows it."""
    known = cell.http.get("api/v1/robots/robot-1/commands").json()["commands"]
    return text in known and not text.startswith("put")


def test_a_real_robot_is_corrected_frozen_released_and_approved_and_a_word_is_taken_back(
    browser: Browser, cell: Cell
) -> None:
    with visited(browser, cell.url) as page:
        at_work(page)

        def press(button: Locator) -> None:
            page.keyboard.press(button.locator("kbd").inner_text())

        text = take_proposal(page, press, partial(possible, cell))
        before = len(cell.said()) - 1
        in_force(page, f"“{text}”")
        expect(page.locator(".caption q")).to_have_text(text)
        page.locator("input[name=words]").fill(WORDS)
        page.locator("input[name=words]").press("Enter")
        in_force(page, f"“{WORDS}”")
        expect(page.locator(".caption q")).to_have_text(WORDS)
        expect(page.locator(".who")).to_have_text("told by person")
        page.keyboard.press("Escape")
        in_force(page, "freeze")
        eventually(lambda: state(cell) == "paused")
        expect(page.locator(".stopped")).to_be_visible()
        page.keyboard.press("c")
        in_force(page, "carry on")
        eventually(lambda: state(cell) == "acting")
        page.keyboard.press("r")
        in_force(page, "release")
        expect(page.locator(".who")).to_contain_text("chosen by π_HL")
        page.keyboard.press("y")
        expect(line(page)).to_contain_text("heard at step")
        eventually(lambda: kinds(cell)[-1] == "approve")
        page.keyboard.press("Control+z")
        eventually(lambda: kinds(cell)[-1] == "retract")
        eventually(lambda: cell.said()[0]["status"] == "in force")
        expect(said(page).filter(has_text="taken back").first).to_be_attached()
    expected = ["override", "override", "pause", "resume", "release", "approve", "retract"]
    assert kinds(cell)[before:] == expected
    assert {view["status"] for view in cell.said()[: len(expected)]} == {"in force"}
