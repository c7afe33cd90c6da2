"""The live page with as much on it as real robots bring: eleven proposals, two of them of two
lines, many things said, two versions measured."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
from playwright.sync_api import Browser, Page, expect

from shared.messages.decision import Decision, Proposal
from shared.messages.episode import Outcome
from shared.messages.goal import LanguageGoal
from shared.messages.policy import Version
from shared.wire.codec import encode
from shared.wire.keys import robot_key
from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.browsing import DESK, PHONE, line, opened, said
from tests.integration.correction_api.fakes import FLEET, FakeLearner, FakeRobot
from tests.integration.correction_api.running import eventually, running

LONG = (
    "pick up the cheese",
    "pick up the lettuce",
    "pick up the slice of tomato on the left",  # As somebody taught it.
    "put it on the plate",
    "pick up the bread",
    "pick up the wrapper",
    "put it down beside the cutting board",
    "pick up the saucer",
    "pick up the toast",
    "put it in the tub",
    "wait",
)
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
UNCOVERED = """
element => {
  const { left, top, right, bottom } = element.getBoundingClientRect();
  const lies = (x, y) => element.contains(document.elementFromPoint(x, y));
  return [left + 9, right - 9].every(x => lies(x, top + 3) && lies(x, bottom - 3));
}
"""
"""Whether an element is in the window and nothing lies over it."""


class CrowdedRobot(FakeRobot):
    """Proposes `LONG` at each decision."""

    def repeat(self, decision: Decision) -> None:
        """Publish a decision, with the long proposals."""
        share = 2 / (len(LONG) * (len(LONG) + 1))
        proposed = tuple(
            Proposal(goal=LanguageGoal(text=text), score=share * (len(LONG) - rank))
            for rank, text in enumerate(LONG)
        )
        told = decision.model_copy(update={"proposed": proposed})
        self.bus.put(robot_key(FLEET, self.name, "decision"), encode(told))


@contextmanager
def crowded(folder: Path) -> Iterator[httpx.Client]:
    """An API that has heard of three such robots and a learner, and of what was said to one."""
    router = MemoryRouter()
    with MemoryBus(router) as bus, MemoryBus(router) as robots:
        fleet = [CrowdedRobot(robots, f"robot-{number}") for number in (1, 2, 3)]
        learner = FakeLearner(robots)
        with running(bus, folder) as api:
            eventually(lambda: len(api.get("api/v1/robots").json()["robots"]) == len(fleet))
            for robot, version in zip(fleet, (0, 1, 1), strict=True):
                robot.version = Version(1, version)
                robot.decide()
                robot.end(Outcome.SUCCESS)
                robot.decide()
            learner.announce("1.1")
            learner.beat()
            eventually(lambda: heard(api) == {robot.name: robot.episode for robot in fleet})
            for text in LONG[:8]:
                told = {"kind": "override", "text": text, "author": "person"}
                api.post("api/v1/robots/robot-1/corrections", json=told).raise_for_status()
            yield api
        learner.close()
        for robot in fleet:
            robot.close()


def heard(api: httpx.Client) -> dict[str, str | None]:
    """The episode in which each robot is, as far as the API has heard."""
    robots = api.get("api/v1/robots").json()["robots"]
    return {robot["robot"]: robot["episode"] for robot in robots}


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
            expect(page.locator(".head .learner .facts").first).to_be_visible()
        page.keyboard.press("y")
        expect(line(page)).to_contain_text("robot-1: heard")
        yield page
