"""Keys and buttons of the live page keep their meaning while proposals change."""

import time
from collections.abc import Iterator

import httpx
import pytest
from playwright.sync_api import Browser, Page, expect

from shared.messages.decision import Decision, Proposal
from shared.messages.goal import LanguageGoal
from tests.integration.correction_api.browsing import line, opened
from tests.integration.correction_api.fakes import COMMANDS, FakeRobot
from tests.integration.correction_api.running import eventually

CANDIDATES = tuple(f"pick up thing {number}" for number in range(20))

ARRANGED = """
async () => {
  const { arrange, unsettled } = await import("./places.js");
  let seed = 7;
  const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647;
  const base = Array.from({ length: 20 }, () => random());
  let places, moved = 0, lost = 0, missing = 0, hasty = 0;
  for (let at = 0; at < 600; at++) {
    const proposed = base
      .map((score, one) => ({ goal: { text: `thing ${one}` }, score: score + 0.1 * random() }))
      .filter(() => random() < 0.6)
      .sort((one, other) => other.score - one.score);
    const now = 1000 * at;
    const next = arrange(places, "e1", proposed, new Set(), now);
    const best = proposed.slice(0, 5).map(({ goal }) => goal.text);
    for (const [key, text] of (places?.texts ?? []).entries()) {
      if (text === null || next.texts[key] === text) continue;
      if (next.texts.includes(text)) moved += 1;
      else if (!best.includes(next.texts[key])) lost += 1;
      if (!unsettled(next, key, now + 200) || unsettled(next, key, now + 1000)) hasty += 1;
    }
    missing += best.filter((text) => !next.texts.includes(text)).length;
    places = next;
  }
  return { moved, lost, missing, hasty };
}
"""


@pytest.fixture
def first(robot: FakeRobot) -> Decision:
    """The first decision of the episode."""
    return robot.decide()


@pytest.fixture
def page(browser: Browser, api: httpx.Client, robot: FakeRobot, first: Decision) -> Iterator[Page]:
    """The page, on which the first nine of the candidates are seen."""
    propose(robot, CANDIDATES[:9], first)
    with opened(browser, api) as page:
        expect(page.locator(".proposal")).to_have_count(9)
        yield page


def propose(robot: FakeRobot, texts: tuple[str, ...], first: Decision) -> None:
    """Publish a decision after the first one with these proposals, the best first."""
    robot.index += 1
    proposed = tuple(
        Proposal(goal=LanguageGoal(text=text), score=0.5 / (rank + 1))
        for rank, text in enumerate(texts)
    )
    new = {"id": f"d{robot.index}", "index": robot.index, "step": robot.step}
    robot.repeat(first.model_copy(update=new | {"proposed": proposed, "time_ns": time.time_ns()}))


def shown(page: Page) -> list[str]:
    return page.locator(".proposal span").all_inner_texts()


def test_with_twenty_changing_candidates_no_phrase_moves_to_another_key(page: Page) -> None:
    assert page.evaluate(ARRANGED) == {"moved": 0, "lost": 0, "missing": 0, "hasty": 0}


def test_a_button_stays_in_its_place_with_the_keyboard_when_its_phrase_is_proposed_no_more(
    page: Page, robot: FakeRobot, first: Decision
) -> None:
    before = shown(page)
    page.locator(".proposal").nth(2).focus()
    propose(robot, (*CANDIDATES[:2], *CANDIDATES[3:9]), first)
    expect(page.locator(".proposal").nth(2).locator("data")).to_have_text("0 %")
    assert shown(page) == before
    expect(page.locator(".proposal").nth(2)).to_be_focused()
    page.keyboard.press("3")
    told = eventually(lambda: robot.heard)[0]
    assert told.goal == LanguageGoal(text=before[2])


def test_a_key_that_has_just_got_another_phrase_does_not_act_at_once(
    page: Page, robot: FakeRobot, first: Decision
) -> None:
    before = shown(page)
    page.evaluate(
        """() => {
          const list = document.querySelector(".proposals");
          new MutationObserver(() => {
            if (!list.textContent.includes("thing 15") || window.pressed) return;
            window.pressed = true;
            document.body.dispatchEvent(new KeyboardEvent("keydown", { key: "9", bubbles: true }));
          }).observe(list, { subtree: true, childList: true, characterData: true });
        }"""
    )
    propose(robot, (CANDIDATES[15], *CANDIDATES[:8]), first)
    expect(line(page)).to_contain_text(f"Proposal 9 has just become “{CANDIDATES[15]}”")
    assert shown(page) == [*before[:8], CANDIDATES[15]]
    assert robot.heard == []
    page.wait_for_timeout(800)
    page.keyboard.press("9")
    told = eventually(lambda: robot.heard)[0]
    assert told.goal == LanguageGoal(text=CANDIDATES[15])


def test_proposals_that_the_robot_could_not_do_get_no_key(
    browser: Browser, api: httpx.Client, robot: FakeRobot, first: Decision
) -> None:
    texts = ("dance", COMMANDS[1], "grab the yellow slice", "do a dance", COMMANDS[2])
    propose(robot, texts, first)
    with opened(browser, api) as page:
        expect(page.locator(".proposal span", has_text=COMMANDS[1])).to_be_visible()
        expect(page.locator(".proposal span", has_text="dance")).to_have_count(0)
        free = page.get_by_role("button", name="no proposal", exact=True)
        expect(free).to_have_count(2)
        expect(free.first).to_have_text("1no proposal")
        assert sorted(set(shown(page)) - {"no proposal"}) == sorted(
            (COMMANDS[1], "grab the yellow slice", COMMANDS[2])
        )
