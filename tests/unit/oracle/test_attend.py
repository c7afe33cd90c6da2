"""When a person says it: at once where the robot waits, else after the reaction time."""

import asyncio
from collections import Counter
from typing import Any

import pytest

from services.oracle.attend import Attention
from services.oracle.client import GoneError, OverError
from services.oracle.config import OracleSettings
from services.oracle.seen import Call, Seen
from shared.errors import RefusedError
from tests.unit.oracle.scenes import scene, seen

BREAD, CHEESE = "pick up the bread", "pick up the cheese"


class FakeClient:
    """Tells the decisions of a script; said: what was posted. Its end ends the test."""

    def __init__(self, *script: Seen | Exception | None) -> None:
        self._script = list(script)
        self.said: list[dict[str, Any]] = []
        self.answers: list[Exception | str] = []
        self.statuses: list[str] = []
        self.asking = True

    async def decision(
        self, robot: str, after: str | None, wait_s: float | None = None
    ) -> Seen | None:
        del robot, after, wait_s  # The script knows what comes next.
        if not self._script:
            raise asyncio.CancelledError
        told = self._script.pop(0)
        if isinstance(told, Exception):
            raise told
        return told

    async def asks(self, robot: str) -> bool:
        del robot
        return self.asking

    async def say(self, robot: str, body: dict[str, Any]) -> str:
        del robot
        self.said.append(body)
        answer = self.answers.pop(0) if self.answers else "in force"
        if isinstance(answer, Exception):
            raise answer
        return answer

    async def status(self, name: str) -> str:
        assert name == self.said[-1]["id"]
        return self.statuses.pop(0)


def attend(client: FakeClient, **settings: Any) -> Counter[str]:
    """Attend until the script is over; the counts."""
    counts: Counter[str] = Counter()
    made = OracleSettings.model_validate({"delay_s": 0.0} | settings)
    attention = Attention("robot-1", client, made, counts)  # type: ignore[arg-type]

    async def run() -> None:
        task = asyncio.create_task(attention.attend())
        await asyncio.wait([task])

    asyncio.run(run())
    return counts


def kinds(client: FakeClient) -> list[str]:
    return [str(body["kind"]) for body in client.said]


def test_a_robot_that_waits_gets_a_verdict_for_each_decision() -> None:
    client = FakeClient(seen(scene(), BREAD, name="ep-1-0"), seen(scene(), CHEESE, name="ep-1-1"))
    counts = attend(client, delay_steps=7)
    assert kinds(client) == ["approve", "override"]
    said = client.said[1]
    assert (said["decision"], said["text"], said["delay_steps"]) == ("ep-1-1", BREAD, 7)
    assert said["hold_steps"] is None
    assert counts == {"decisions": 2, "approve": 1, "override": 1}


def test_who_does_not_approve_passes_so_that_the_robot_goes_on() -> None:
    client = FakeClient(seen(scene(), BREAD))
    attend(client, approve=False)
    assert kinds(client) == ["pass"]


def test_a_verdict_that_did_not_reach_the_robot_is_said_again_as_something_new() -> None:
    client = FakeClient(seen(scene(), BREAD), None, None, None, None)
    client.answers = [RefusedError("the robot did not understand"), "pending", "in force"]
    client.statuses = ["pending", "expired"]
    counts = attend(client)
    assert kinds(client) == ["approve"] * 3
    assert len({body["id"] for body in client.said}) == 3
    assert (counts["refused"], counts["approve"]) == (1, 2)


@pytest.mark.parametrize("answer", ["in force", OverError("the episode is over")])
def test_a_robot_that_takes_its_time_is_not_told_twice(answer: Exception | str) -> None:
    client = FakeClient(seen(scene(), CHEESE), None, None)
    client.answers = [answer]
    attend(client)
    assert kinds(client) == ["override"]


def test_the_same_decision_gets_the_same_id_from_whoever_sees_it_again() -> None:
    first, second = FakeClient(seen(scene(), BREAD)), FakeClient(seen(scene(), BREAD))
    attend(first)
    attend(second)
    assert first.said[0]["id"] == second.said[0]["id"]


def test_in_real_time_only_what_stays_wrong_is_corrected() -> None:
    wrong = seen(scene(), CHEESE, name="ep-1-0", awaits_verdict=False)
    right = seen(scene(), BREAD, name="ep-1-1", awaits_verdict=False)
    later = wrong.model_copy(update={"id": "ep-1-2", "step": 40})
    mended, lasting = FakeClient(wrong, right), FakeClient(wrong, later)
    attend(mended, delay_s=0.01)
    attend(lasting, delay_s=0.01)
    assert mended.said == []
    assert kinds(lasting) == ["override"]
    said = lasting.said[0]
    assert (said["decision"], said["seen_step"], said["text"]) == ("ep-1-2", 40, BREAD)


def test_in_real_time_silence_is_consent_unless_told_otherwise() -> None:
    right = seen(scene(), BREAD, awaits_verdict=False)
    silent, loud = FakeClient(right), FakeClient(right)
    attend(silent)
    attend(loud, approve=True)
    assert kinds(silent) == []
    assert kinds(loud) == ["approve"]


def test_a_miss_in_real_time_says_nothing_at_all() -> None:
    client = FakeClient(seen(scene(), CHEESE, awaits_verdict=False))
    assert attend(client, miss_rate=1.0)["missed"] == 1
    assert client.said == []


def test_a_robot_that_is_gone_is_waited_for() -> None:
    client = FakeClient(GoneError("no robot"), seen(scene(), BREAD))
    attend(client)
    assert kinds(client) == ["approve"]


ASKS, WAITS = Call(waits_s=0), Call(waits_s=10)


def test_who_comes_only_when_asked_leaves_the_others_alone() -> None:
    wrong = seen(scene(), CHEESE, awaits_verdict=False)
    in_doubt = wrong.model_copy(update={"id": "ep-1-1", "help": ASKS})
    client = FakeClient(wrong, in_doubt, None)
    counts = attend(client, only_when_asked=True)
    assert [said["decision"] for said in client.said] == ["ep-1-1"]
    assert counts["unasked"] == 1


def test_a_robot_whose_call_is_beyond_the_fleets_budget_has_not_asked() -> None:
    client = FakeClient(seen(scene(), CHEESE, awaits_verdict=False, help=ASKS))
    client.asking = False
    attend(client, only_when_asked=True)
    assert client.said == []


def test_who_comes_only_when_asked_passes_what_waits_for_a_verdict_unasked() -> None:
    wrong = seen(scene(), CHEESE, name="ep-1-0")
    client = FakeClient(wrong, wrong.model_copy(update={"id": "ep-1-1", "help": ASKS}))
    attend(client, only_when_asked=True)
    assert kinds(client) == ["pass", "override"]


def test_who_was_asked_stays_until_the_word_can_be_given_back() -> None:
    held = seen(scene(), CHEESE, top=BREAD, chosen_by="cor-1", awaits_verdict=False)
    client = FakeClient(held, None)
    attend(client, only_when_asked=True)
    assert kinds(client) == ["release"]


def test_a_robot_that_stands_still_in_doubt_is_told_that_it_is_right() -> None:
    right = seen(scene(), BREAD, awaits_verdict=False, help=WAITS)
    client, hasty = FakeClient(right, right), FakeClient(right, right)
    attend(client)
    attend(hasty, approve=False)
    assert (kinds(client), kinds(hasty)) == (["approve"], ["pass"])


def test_who_does_not_look_lets_it_wait_in_vain() -> None:
    client = FakeClient(seen(scene(), CHEESE, awaits_verdict=False, help=WAITS), None)
    assert attend(client, miss_rate=1.0)["missed"] == 1
    assert client.said == []
