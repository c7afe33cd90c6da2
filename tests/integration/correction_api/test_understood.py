"""Words about the past are kept only where some low level could obey them, as robots tell."""

from pathlib import Path
from typing import Any

import httpx
from playwright.sync_api import Browser, expect

from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.browsing import line, opened
from tests.integration.correction_api.fakes import COMMANDS, FakeLearner, FakeRobot
from tests.integration.correction_api.running import eventually, running
from tests.integration.correction_api.test_past import OVERRIDE, STEPS, ended, say

NONSENSE = "dance around"


def relabel(episode: str, text: str) -> dict[str, Any]:
    return {"kind": "relabel", "episode": episode, "text": text, **STEPS}


def refused(answer: httpx.Response) -> bool:
    problem = answer.json()
    assert problem["type"].endswith("not-understood")
    assert "doesn't understand 'dance around'" in problem["detail"]
    return (answer.status_code, problem["nearest"]) == (422, [COMMANDS[0], COMMANDS[4]])


def heard_of(api: httpx.Client, count: int) -> None:
    eventually(lambda: len(api.get("api/v1/robots").json()["robots"]) == count)


def test_a_relabel_or_an_edit_that_the_low_level_does_not_understand_is_not_kept(
    api: httpx.Client, robot: FakeRobot
) -> None:
    over = ended(api, robot)
    assert refused(say(api, relabel(over.id, NONSENSE)))
    assert refused(say(api, {"kind": "edit", "target": "say-1", "text": NONSENSE}))
    kept = api.get("api/v1/corrections").json()["corrections"]
    assert [view["correction"]["id"] for view in kept] == [OVERRIDE["id"]]
    answer = say(api, relabel(over.id, "grab the yellow slice"))
    assert (answer.status_code, answer.json()["reason"]) == (201, "")


def test_another_robot_of_the_same_low_level_answers_for_one_that_is_away(
    api: httpx.Client, robot: FakeRobot, learner: FakeLearner, router: MemoryRouter
) -> None:
    over = ended(api, robot)
    learner.announce()
    robot.close()
    with MemoryBus(router) as bus:
        other = FakeRobot(bus, "robot-2")
        other.low_level_sha256 = "77" * 32
        heard_of(api, 2)
        doubt = say(api, relabel(over.id, NONSENSE)).json()
        assert doubt["status"] == "kept"
        assert "no robot could be asked" in doubt["reason"]
        other.low_level_sha256 = "5d" * 32
        assert refused(say(api, relabel(over.id, NONSENSE)))
        other.close()


def test_where_nobody_can_be_asked_it_is_kept_and_says_so_also_later(
    api: httpx.Client, robot: FakeRobot
) -> None:
    over = ended(api, robot)
    robot.close()
    said = say(api, {**relabel(over.id, NONSENSE), "id": "say-2"})
    assert (said.status_code, said.json()["status"]) == (201, "kept")
    for view in (said.json(), api.get("api/v1/corrections/say-2").json()):
        assert view["reason"] == "no robot could be asked whether its low level understands this"


def test_known_is_what_the_low_level_knows_and_not_what_was_once_said(
    router: MemoryRouter, tmp_path: Path
) -> None:
    with MemoryBus(router) as bus, running(bus, tmp_path) as api:
        learner = FakeLearner(bus)
        learner.announce(bank=(*COMMANDS, "hop"))
        robot = FakeRobot(bus)
        heard_of(api, 1)

        def known() -> bool | None:
            answer = say(api, {"kind": "override", "text": "hop"}).json()
            return bool(answer["phrase"]["known"])

        eventually(lambda: not known())
        told = api.get("api/v1/robots/robot-1/commands?anywhere=true").json()
        assert (told["commands"], told["asked"]) == ([*COMMANDS], True)
        robot.close()
        learner.close()


def test_stop_in_the_palette_stops_the_robot_and_is_no_word_to_learn(
    browser: Browser, api: httpx.Client, robot: FakeRobot
) -> None:
    with opened(browser, api) as page:
        for word in ("stop", "Halt!", "freeze"):
            before = len(robot.heard)
            page.locator("input[name=words]").fill(word)
            option = page.locator("[role=option]").first
            expect(option).to_contain_text("freezes the robot")
            page.locator("input[name=words]").press("Enter")
            eventually(lambda before=before: len(robot.heard) > before)
            assert robot.heard[-1].kind == "pause"
            expect(line(page)).to_contain_text("freeze, robot-1: in force since step")
