"""What a learner keeps and tells, without the learner: its real store, collector and teller."""

from collections.abc import Iterable, Iterator
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path
from typing import Any

import httpx

from services.learner.collect import Collector
from services.learner.store.archive import Archive
from services.learner.store.sql import SqlStore, sqlite_url
from services.learner.store.store import Manifest, Marks, PolicyRecord, Round, RoundState
from services.learner.tell import Teller
from shared.clock import SystemClock
from shared.messages.episode import Episode, Outcome
from shared.messages.policy import TensorRef
from shared.wire.codec import encode
from shared.wire.keys import robot_key
from shared.wire.memory import MemoryBus, MemoryRouter
from tests.integration.correction_api.fakes import COMMANDS, FLEET, FakeRobot
from tests.integration.correction_api.running import eventually, running

TRIALS = {
    "candidate": {"success": 0.71, "n": 200, "interval": [0.64, 0.77]},
    "in_force": {"success": 0.52, "n": 200, "interval": [0.45, 0.59]},
    "p": 0.0002,
}
STEPS = 20
"""Of a decision."""
UNJUDGED = "held out 3 labels, needs 20: not judged"


@contextmanager
def kept(folder: Path) -> Iterator[tuple[httpx.Client, FakeRobot]]:
    """An API, a robot that it has heard of, and the learner that keeps what that decides."""
    router = MemoryRouter()
    with keeping(router, folder), MemoryBus(router) as bus, MemoryBus(router) as robots:
        robot = FakeRobot(robots)
        with running(bus, folder) as api:
            eventually(lambda: api.get("api/v1/robots").json()["robots"])
            yield api, robot
        robot.close()


def attempt(
    api: httpx.Client, robot: FakeRobot, outcome: Outcome = Outcome.SUCCESS, decisions: int = 3
) -> Episode:
    """An episode whose decisions the learner has, and the API knows to be over."""
    decide(robot, [robot.command] * decisions)
    return over(api, robot.end(outcome))


def decide(robot: FakeRobot, commands: Iterable[str]) -> None:
    """Decisions that the learner keeps, each with its command in force for 20 steps."""
    for command in commands:
        robot.command = command
        decision = robot.decide()
        robot.bus.ask(robot_key(FLEET, robot.name, "decision"), encode(decision), timeout_s=60)
        robot.step += STEPS


def over(api: httpx.Client, episode: Episode) -> Episode:
    """The episode, as soon as the API knows that it is over."""
    eventually(lambda: api.get(f"api/v1/episodes/{episode.id}").json().get("episode"))
    return episode


@contextmanager
def keeping(router: MemoryRouter, folder: Path) -> Iterator[SqlStore]:
    """A store with two versions, a round that passed and one that the gate held back."""
    url = sqlite_url(folder / "learner.db")
    with ExitStack() as stack:
        bus = stack.enter_context(MemoryBus(router))
        store = stack.enter_context(closing(SqlStore(url)))
        collector = stack.enter_context(closing(Collector(bus, FLEET, store, SystemClock())))
        collector.start()
        archive = stack.enter_context(closing(Archive(url)))
        stack.enter_context(closing(Teller(bus, FLEET, "learner-1", archive)))
        turn_rounds(store)
        yield store


def turn_rounds(store: SqlStore) -> None:
    """Found the store; 14 corrections made version 1, 3 more made nothing that went out."""
    store.take_over("learner-1", 1)
    store.found(version(0))
    store.begin(round_(1, corrections=14))
    figures: dict[str, Any] = {"trials": TRIALS, "unjudged": UNJUDGED}
    passed = round_(1, corrections=14, state=RoundState.PASSED, made=1, figures=figures)
    store.end(passed, version(1))
    store.begin(round_(2, corrections=3, parent=1))
    figures = {"held_out": 40, "before": 0.8, "after": 0.6, "finite": True}
    refused = {"figures": figures, "candidate": {"tensors": []}, "reason": "it agrees with .600"}
    store.end(round_(2, corrections=3, parent=1, state=RoundState.REFUSED, **refused))


def version(number: int) -> PolicyRecord:
    tensor = TensorRef(name="w", sha256="0" * 64, dtype="float32", shape=(1,), size_bytes=4)
    return PolicyRecord(
        number=number,
        epoch=1,
        tensors=(tensor,),
        bank=COMMANDS,
        settings={},
        low_level_sha256="5d" * 32,
        marks=Marks(),
        created_ns=1_795_442_300_000_000_000 + number,
    )


def round_(number: int, corrections: int, **fields: Any) -> Round:
    manifest = Manifest(episodes=4, corrections=corrections)
    begun = {"number": number, "epoch": 1, "parent": 0, "seed": number, "begun_ns": number}
    return Round.model_validate({**begun, "manifest": manifest, **fields})
