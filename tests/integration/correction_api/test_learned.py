"""The API asks the learner what it learned at each version, until it is told, and keeps it."""

from pathlib import Path

import httpx

from shared.messages.policy import Version
from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.fakes import FakeLearner, FakeRobot
from tests.integration.correction_api.running import eventually, running

WAIT = {"kind": "override", "text": "wait", "author": "anna"}


def learned_in(api: httpx.Client) -> list[str | None]:
    views = api.get("api/v1/corrections").json()["corrections"]
    return [view["learned_in"] for view in reversed(views)]


def test_what_was_learned_is_told_also_after_a_restart_and_while_the_learner_is_away(
    router: MemoryRouter, robot: FakeRobot, learner: FakeLearner, tmp_path: Path
) -> None:
    with MemoryBus(router) as bus, running(bus, tmp_path) as api:
        eventually(lambda: api.get("api/v1/robots").json()["robots"])
        for _ in range(2):
            api.post("api/v1/robots/robot-1/corrections", json=WAIT).raise_for_status()
        first, second = (correction.id for correction in robot.heard)
        learner.announce("1.0")
        eventually(lambda: learner.asked == [2])
        learner.learned[first] = Version(1, 1)
        learner.announce("1.1")
        eventually(lambda: learned_in(api) == ["1.1", None])
    learner.learned[second] = Version(1, 2)
    learner.announce("1.2")  # Nobody hears it.
    with MemoryBus(router) as bus, running(bus, tmp_path) as api:
        eventually(lambda: learned_in(api) == ["1.1", "1.2"])
        view = api.get(f"api/v1/corrections/{first}").json()
        assert view["learned_in"] == "1.1"


def test_what_was_learned_of_an_endorsement_is_told_too(
    api: httpx.Client, robot: FakeRobot, learner: FakeLearner
) -> None:
    said = {"kind": "endorse", "episode": robot.episode, "first_step": 0, "end_step": 50}
    said |= {"author": "anna"}
    name = api.post("api/v1/robots/robot-1/corrections", json=said).json()["correction"]["id"]
    learner.learned[name] = Version(1, 1)
    learner.announce("1.1")
    eventually(lambda: learned_in(api) == ["1.1"])


def test_a_learner_that_does_not_answer_is_asked_again(
    router: MemoryRouter, robot: FakeRobot, tmp_path: Path
) -> None:
    with MemoryBus(router) as bus, MemoryBus(router) as mute, running(bus, tmp_path) as api:
        eventually(lambda: api.get("api/v1/robots").json()["robots"])
        api.post("api/v1/robots/robot-1/corrections", json=WAIT).raise_for_status()
        deaf = FakeLearner(mute)
        deaf.close()
        deaf.announce("1.1")
        with MemoryBus(router) as late:
            learner = FakeLearner(late)
            learner.learned[robot.heard[0].id] = Version(1, 1)
            eventually(lambda: learned_in(api) == ["1.1"])
            learner.close()


def test_a_robot_tells_its_commands_and_what_it_would_make_of_a_phrase(
    api: httpx.Client, robot: FakeRobot
) -> None:
    told = api.get("api/v1/robots/robot-1/commands").json()
    assert (told["asked"], "wait" in told["commands"]) == (True, True)
    query = {"text": "grab the yellow slice"}
    read = api.get("api/v1/robots/robot-1/phrase", params=query).json()
    assert (read["known"], read["means"], read["refused"]) == (False, "pick up the cheese", "")
    read = api.get("api/v1/robots/robot-1/phrase", params={"text": "dance"}).json()
    assert (read["means"], read["refused"][:20]) == (None, "the low level doesn'")
    assert api.get("api/v1/robots/robot-1/phrase", params={"text": " "}).status_code == 422
    assert robot.heard == []


def test_of_a_robot_that_is_away_the_commands_of_its_policy_are_told(
    api: httpx.Client, robot: FakeRobot, learner: FakeLearner
) -> None:
    learner.announce()
    robot.close()
    told = eventually(lambda: api.get("api/v1/robots/robot-1/commands").json())
    assert told["asked"] is False
    assert "wait" in told["commands"]
    assert api.get("api/v1/robots/robot-1/phrase", params={"text": "x"}).status_code == 503
