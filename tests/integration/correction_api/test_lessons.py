"""What somebody taught, and whether the robot that they taught runs it."""

from pathlib import Path
from typing import Any

import httpx
import pytest
from playwright.sync_api import Browser, expect

from services.learner.store.store import Answer
from shared.messages.policy import Version
from shared.messages.ruling import Ruling, Verb
from shared.wire.memory import MemoryRouter
from tests.integration.correction_api.browsing import PHONE, opened, said
from tests.integration.correction_api.fakes import COMMANDS, FakeLearner, FakeRobot
from tests.integration.correction_api.keeper import keeping, version
from tests.integration.correction_api.running import eventually

PLACE = """
async ([learned, runs, told]) => {
  const { place } = await import("./lineage.js");
  const { words, lost } = place(learned, { robot: "robot-1", version: runs }, told);
  return `${words}${lost ? " (lost)" : ""}`;
}
"""


def made(number: int, **how: Any) -> dict[str, Any]:
    return {"version": f"1.{number}", "number": number, "round": None, "again": None} | how


HISTORY = {
    "versions": [
        made(0),
        made(1, round=1),
        made(2, round=3),
        made(3, again=1),
        made(4, again=2),
        made(5),  # Somebody promoted what round 2 had made.
        made(6, round=4),
        made(7, again=3),
    ],
    "rulings": [{"made": 5, "ruling": {"verb": "promote", "round": 2}}],
}


@pytest.mark.parametrize(
    ("learned", "runs", "words"),
    [
        ("1.2", "1.2", ", which robot-1 runs"),
        ("1.2", "2.2", ", which robot-1 runs"),  # Another learner has taken over the store.
        ("1.2", "1.1", "; robot-1 still runs 1.1"),
        ("2.1", "1.9", "; robot-1 still runs 1.9"),
        ("1.2", "1.10", "; robot-1 runs 1.10"),  # The learner did not tell of it.
        ("1.1", "1.2", "; robot-1 has it in 1.2"),
        ("1.2", "1.4", "; robot-1 has it in 1.4"),
        ("1.2", "1.3", ", rolled back to 1.1 by 1.3, which robot-1 runs (lost)"),
        ("1.2", "1.7", ", rolled back to 1.1 by 1.7, which robot-1 runs (lost)"),
        ("1.2", "1.5", ", not in 1.5, which robot-1 runs (lost)"),
        ("1.5", "1.6", "; robot-1 has it in 1.6"),
    ],
)
def test_a_lesson_is_in_a_later_version_unless_somebody_went_back_before_it(
    browser: Browser, standing_api: httpx.Client, learned: str, runs: str, words: str
) -> None:
    with opened(browser, standing_api) as page:
        assert page.evaluate(PLACE, [learned, runs, HISTORY]) == words


def test_what_was_learned_says_whether_the_robot_that_was_corrected_runs_it(
    browser: Browser,
    api: httpx.Client,
    robot: FakeRobot,
    learner: FakeLearner,
    router: MemoryRouter,
    tmp_path: Path,
) -> None:
    robot.decide()
    with keeping(router, tmp_path) as store, opened(browser, api, PHONE) as page:
        expect(page.locator(".proposal")).to_have_count(len(COMMANDS))
        page.keyboard.press("2")
        name = eventually(lambda: robot.heard)[0].id
        where = page.locator(".said .where")
        expect(where).to_contain_text("in force since step")
        learner.learned[name] = Version(1, 1)
        learner.announce("1.1")
        expect(where).to_contain_text("→ learned in 1.1; robot-1 still runs 1.0")
        robot.version = Version(1, 1)
        expect(where).to_contain_text("→ learned in 1.1, which robot-1 runs")
        expect(page.locator(".said li.learned")).to_have_count(1)
        ruling = Ruling(
            id="rule-1", verb=Verb.ROLLBACK, author="anna", version=0, reason="r", created_ns=1
        )
        back = version(2).model_copy(update={"again": 0, "ruling": ruling.id})
        store.add(ruling, 1)
        store.answer(Answer(ruling=ruling, answered_ns=2, made=2), back)
        robot.version = Version(1, 2)
        expect(where).to_contain_text("→ learned in 1.1, rolled back to 1.0 by 1.2, which robot-1")
        expect(page.locator(".said li.lost")).to_have_count(1)
        assert page.evaluate("document.documentElement.scrollWidth") <= PHONE[0]
        page.locator(".said .back").click()
        expect(where.last).to_contain_text("taken back")
        expect(where.last).not_to_contain_text("rolled back")


def test_without_a_learner_only_what_is_known_is_said(
    browser: Browser, api: httpx.Client, robot: FakeRobot, learner: FakeLearner
) -> None:
    robot.decide()
    api.post("api/v1/robots/robot-1/corrections", json={"kind": "release"})
    learner.learned[robot.heard[0].id] = Version(1, 1)
    learner.announce("1.1")
    robot.version = Version(1, 2)
    page = browser.new_page()
    page.goto(str(api.base_url))
    expect(said(page).first).to_contain_text("→ learned in 1.1; robot-1 runs 1.2")
    page.close()
