"""A person corrects a robot that works in real time, with nothing but HTTP."""

import pytest

from tests.loop.fleet import Fleet

pytestmark = pytest.mark.alone


@pytest.fixture(scope="module")
def fleet(tmp_path_factory):
    sets = ("actor.rollout.max_steps=100000",)
    with Fleet(tmp_path_factory.mktemp("fleet"), pace="real-time", sets=sets) as fleet:
        yield fleet


def correct(fleet, **body):
    return fleet.http.post("/robots/robot-1/corrections", json={"author": "ada", **body})


def other_command(robot):
    """Something to say that is not what the robot does anyway."""
    texts = ["pick up the cheese", "pick up the tomato"]
    return next(text for text in texts if text != robot["command"]["text"])


def test_the_receipt_names_the_step_and_the_command_changes_at_the_next_control_step(fleet):
    robot = fleet.robot()
    said = other_command(robot)
    answer = correct(fleet, kind="override", text=said)
    assert answer.status_code == 201, answer.text
    body = answer.json()
    step = body["receipt"]["step"]
    assert body["status"] == "in force"
    assert step >= robot["step"]
    # After an interjection π_HL looks at once, so a decision tells what was in force when.
    later = f"{of_this_episode(body)} and step >= {step} order by step limit 1"
    found, executed, chosen_by = fleet.wait_for(
        lambda: fleet.read("learner", later), "a decision after the receipt"
    )[0]
    assert (executed, chosen_by) == (said, body["correction"]["id"])
    assert found - step <= 1
    earlier = f"{of_this_episode(body)} and step < {step} order by step desc limit 1"
    assert fleet.read("learner", earlier)[0][1] != said


def of_this_episode(body):
    episode = body["correction"]["episode"]
    return f"select step, executed, chosen_by from decisions where episode = '{episode}'"


def test_release_gives_the_command_back_to_the_high_level(fleet):
    robot = fleet.robot()
    assert correct(fleet, kind="override", text=other_command(robot)).status_code == 201
    assert correct(fleet, kind="release").status_code == 201
    fleet.wait_for(lambda: fleet.robot()["chosen_by"] == "1.0", "the high level decides again")


def test_an_override_expires_by_itself(fleet):
    robot = fleet.robot()
    answer = correct(fleet, kind="override", text=other_command(robot), hold_steps=25)
    assert answer.status_code == 201
    fleet.wait_for(lambda: fleet.robot()["chosen_by"] == "1.0", "the override has expired")


def test_a_paused_robot_stands_still_until_it_is_resumed(fleet):
    assert correct(fleet, kind="pause").status_code == 201
    fleet.wait_for(lambda: fleet.robot()["state"] == "paused", "the robot has paused")
    step = fleet.robot()["step"]
    assert fleet.robot()["step"] == step
    assert correct(fleet, kind="resume").status_code == 201
    fleet.wait_for(lambda: fleet.robot()["step"] > step, "the robot moves again")


@pytest.mark.parametrize(
    ("robot", "body", "status", "words"),
    [
        ("robot-9", {"kind": "override", "text": "wait"}, 404, "robot-1"),
        ("robot-1", {"kind": "override", "text": "  "}, 422, "text"),
        ("robot-1", {"kind": "override", "text": "a" * 1000}, 422, "200"),
        ("robot-1", {"kind": "override", "txet": "wait"}, 422, "text"),
        ("robot-1", {"kind": "overrule", "text": "wait"}, 422, "override"),
        ("robot-1", {"kind": "override", "text": "wait", "episode": "ep-gone"}, 409, "over"),
    ],
)
def test_bad_input_is_answered_with_what_would_be_right(fleet, robot, body, status, words):
    fleet.robot()
    answer = fleet.http.post(f"/robots/{robot}/corrections", json={"author": "ada", **body})
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"].startswith("application/problem+json")
    problem = answer.json()
    assert problem["status"] == status
    assert words in str(problem)
    assert fleet.robot()["state"] == "acting"
