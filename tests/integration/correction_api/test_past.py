"""What is said of the past: taken back, reworded, moved, said after the fact, laid on the hand."""

from pathlib import Path
from typing import Any

import httpx
import pytest

from shared.messages.correction import AFTERWARDS, Kind
from shared.messages.episode import Episode
from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.fakes import FakeLearner, FakeRobot
from tests.integration.correction_api.running import eventually, running

ROBOT = "api/v1/robots/robot-1"
OVERRIDE = {"kind": "override", "text": "pick up the tomato", "author": "anna", "id": "say-1"}
STEPS = {"first_step": 0, "end_step": 5}


def say(api: httpx.Client, body: dict[str, Any]) -> httpx.Response:
    return api.post(f"{ROBOT}/corrections", json={"author": "anna", **body})


def about(episode: str) -> list[dict[str, Any]]:
    """One of each kind, about `say-1` or this episode."""
    return [
        {"kind": "edit", "target": "say-1", "text": "pick up the ham"},
        {"kind": "retime", "target": "say-1", **STEPS},
        {"kind": "relabel", "episode": episode, "text": "wait", **STEPS},
        {"kind": "fault", "decision": f"{episode}-0"},
        {"kind": "fault", "episode": episode, **STEPS},
        {"kind": "endorse", "episode": episode, **STEPS},
        {"kind": "retract", "target": "say-1"},
    ]


def ended(api: httpx.Client, robot: FakeRobot) -> Episode:
    """An episode with a decision and the correction `say-1`, that the API knows to be over."""
    robot.decide()
    eventually(lambda: robot.step >= 5)
    assert say(api, OVERRIDE).status_code == 201
    over = robot.end()
    eventually(lambda: api.get("api/v1/episodes").json()["episodes"])
    return over


def test_in_a_running_episode_the_robot_hears_them(api: httpx.Client, robot: FakeRobot) -> None:
    robot.decide()
    eventually(lambda: (api.get(ROBOT).json()["decision"] or {}) and robot.step >= 5)
    assert say(api, OVERRIDE).status_code == 201
    bodies = about(robot.episode)
    assert {Kind(body["kind"]) for body in bodies} == AFTERWARDS
    answers = [say(api, body) for body in bodies]
    assert [(one.status_code, one.json().get("status")) for one in answers] == [
        (201, "in force")
    ] * len(bodies)
    assert [heard.kind for heard in robot.heard][1:] == [body["kind"] for body in bodies]
    assert all(heard.episode == robot.episode for heard in robot.heard)


def test_about_an_episode_that_is_over_they_are_kept_and_no_robot_is_asked(
    api: httpx.Client, robot: FakeRobot, learner: FakeLearner
) -> None:
    over = ended(api, robot)
    for number, body in enumerate(about(over.id)):
        name = f"late-{number}"
        answer = say(api, {**body, "id": name})
        assert (answer.status_code, answer.json()["status"]) == (201, "kept")
        said = answer.json()["correction"]
        assert (said["episode"], said["kind"]) == (over.id, body["kind"])
        assert answer.json()["receipt"] is None
        assert say(api, {**body, "id": name}).json() == answer.json()
        assert say(api, {**body, "id": name, "author": "bob"}).status_code == 409
        eventually(lambda name=name: ("correction", name) in learner.taken)
    assert [heard.id for heard in robot.heard] == ["say-1"]
    assert {name for kind, name in learner.taken if kind == "receipt"} == {"say-1"}


def test_after_a_restart_with_the_robot_away_the_past_can_be_spoken_of(
    router: MemoryRouter, tmp_path: Path
) -> None:
    with MemoryBus(router) as bus, MemoryBus(router) as robots:
        robot = FakeRobot(robots)
        with running(bus, tmp_path) as api:
            eventually(lambda: api.get("api/v1/robots").json()["robots"])
            over = ended(api, robot)
        robot.close()
        with running(bus, tmp_path) as api:
            assert api.get("api/v1/robots").json()["robots"] == []
            for number, body in enumerate(about(over.id)):
                answer = say(api, {**body, "id": f"late-{number}"})
                assert (answer.status_code, answer.json()["status"]) == (201, "kept"), answer.text
            unknown = say(api, {"kind": "relabel", "episode": "ep-9", "text": "wait", **STEPS})
            assert (unknown.status_code, unknown.json()["type"][-14:]) == (404, ":unknown-robot")
    with MemoryBus(router) as bus, MemoryBus(router) as learners, running(bus, tmp_path) as api:
        shown = api.get("api/v1/corrections/late-0").json()
        assert (shown["status"], shown["correction"]["target"]) == ("kept", "say-1")
        learner = FakeLearner(learners)
        kept = [("correction", f"late-{number}") for number in range(len(about("")))]
        eventually(lambda: learner.taken[-len(kept) :] == kept)
        learner.close()


def test_an_edit_of_what_holds_shows_in_the_robots_command(
    api: httpx.Client, robot: FakeRobot
) -> None:
    assert say(api, OVERRIDE).status_code == 201
    assert say(api, {"kind": "edit", "target": "say-1", "text": "wait"}).status_code == 201
    shown = api.get(ROBOT).json()
    assert (shown["command"]["text"], shown["chosen_by"]) == ("wait", "say-1")
    assert len(robot.heard) == 2


@pytest.mark.parametrize(
    ("body", "status", "detail"),
    [
        ({"kind": "retract", "target": "say-l"}, 404, "no correction 'say-l'; nearest known: 'say"),
        ({"kind": "retract"}, 422, "retract needs target; missing: target"),
        ({"kind": "retract", "target": "say-1", "text": "x"}, 422, "retract has no text"),
        ({"kind": "edit", "target": "say-1"}, 422, "edit needs text and target; missing: text"),
        ({"kind": "retract", "target": "back"}, 422, "say it again"),
        ({"kind": "edit", "target": "edited", "text": "x"}, 422, "the last edit counts"),
        ({"kind": "retime", "target": "yes", **STEPS}, 422, "retime is for override, relabel, fau"),
        ({"kind": "retract", "target": "say-1", "episode": "ep-1"}, 422, "leave episode out"),
        ({"kind": "relabel", "text": "x", **STEPS}, 422, "relabel needs episode: which one"),
        ({"kind": "relabel", "text": "x", "episode": "ep-1", **STEPS}, 409, "no episode 'ep-1' of"),
        (
            {"kind": "relabel", "text": "x", "episode": "robot-1-e1", "first_step": 3},
            422,
            "missing: end_step",
        ),
        (
            {"kind": "fault", "episode": "robot-1-e1", "first_step": 3, "end_step": 99_999},
            422,
            "end_step: 99999 lies beyond what is known of robot-1-e1; at most",
        ),
        ({"kind": "fault"}, 422, "a fault needs decision, or first_step and end_step"),
        ({"kind": "fault", "decision": "robot-1-e1-7"}, 404, "the last one is robot-1-e1-0"),
        ({"kind": "fault", "decision": "nonsense"}, 404, "ids of decisions are EPISODE-NUMBER"),
    ],
)
def test_a_mistake_about_the_past_is_told_with_what_would_be_right(
    finished: httpx.Client, body: dict[str, Any], status: int, detail: str
) -> None:
    answer = say(finished, body)
    assert answer.status_code == status, answer.text
    assert answer.headers["Content-Type"] == "application/problem+json"
    assert detail in answer.json()["detail"]


def test_what_was_said_of_another_robot_is_refused(
    finished: httpx.Client, router: MemoryRouter
) -> None:
    del router
    path = "api/v1/robots/robot-2/corrections"
    answer = finished.post(path, json={"kind": "retract", "target": "say-1"})
    assert answer.status_code == 422
    assert answer.json()["detail"] == "say-1 is about robot-1, not about robot-2; say this of it"


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """An API that knows a finished episode, an approval, an edit and a retraction in it."""
    router = MemoryRouter()
    with MemoryBus(router) as bus, MemoryBus(router) as robots:
        robot = FakeRobot(robots)
        with running(bus, tmp_path_factory.mktemp("api")) as api:
            eventually(lambda: api.get("api/v1/robots").json()["robots"])
            decision = robot.decide()
            eventually(lambda: api.get(ROBOT).json()["decision"])
            assert say(api, OVERRIDE).status_code == 201
            for body in (
                {"kind": "approve", "decision": decision.id, "id": "yes"},
                {"kind": "edit", "target": "say-1", "text": "wait", "id": "edited"},
                {"kind": "retract", "target": "yes", "id": "back"},
            ):
                assert say(api, body).status_code == 201
            robot.end()
            eventually(lambda: api.get("api/v1/episodes").json()["episodes"])
            yield api
        robot.close()
