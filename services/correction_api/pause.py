"""Pause: every robot at once, or some of them, each by a correction of its own.

Robots that have fallen silent are told after the others, so that nobody waits for one that is gone.
One that is between two episodes begins the next one standing still.
"""

import asyncio
import hashlib
from collections.abc import Collection, Container, Iterable
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, JsonValue

from services.correction_api.parts import Parts
from services.correction_api.problems import Problem
from services.correction_api.show import show_correction
from services.correction_api.store.log import Entry, Status
from services.correction_api.utterance import Line, Nanoseconds, Utterance
from services.correction_api.views import CorrectionView, Presence, View
from shared.messages.correction import Kind
from shared.messages.message import Id

LOOK_S = 0.02
EXAMPLES: list[JsonValue] = [{}, {"robots": ["robot-1"], "id": "stop-0a1b2c3d", "author": "anna"}]


class PauseBody(BaseModel):
    """Who stops the robots; nothing of it is needed.

    robots: only these; all if it is not given.
    begun_ns: when you began, in ns since 1970; now if it is not given.
    id: a name of your own, so that it can be sent again without being said twice; the header
        `Idempotency-Key` does the same.
    """

    model_config = ConfigDict(
        frozen=True, extra="forbid", json_schema_extra={"examples": [*EXAMPLES]}
    )

    robots: Annotated[tuple[Id, ...], Field(min_length=1, max_length=256)] | None = None
    author: Id = "person"
    begun_ns: Nanoseconds | None = None
    note: Line | None = None
    id: Id | None = None

    def utterance(self, author: str | None) -> Utterance:
        """What is said to each robot. author: whose token came with it, if tokens have names."""
        said = {"author": author or self.author, "begun_ns": self.begun_ns, "note": self.note}
        return Utterance.model_validate({"kind": Kind.PAUSE, **said})


class PausedView(View):
    """What became of it at one robot.

    status: pending means that it gave no receipt yet, and is asked until it does or time runs out.
    reason: why it does not stand still, or is not known to. correction: null: nothing was kept.
    """

    robot: Annotated[Id, Field(examples=["robot-1"])]
    status: Status
    reason: str = ""
    correction: CorrectionView | None = None


class PauseView(View):
    """All robots that were meant, by name. id: sent again, nothing is said twice."""

    id: Annotated[Id, Field(examples=["stop-0a1b2c3d"])]
    robots: list[PausedView]


async def pause_all(
    parts: Parts, said: Utterance, name: str, robots: Collection[str] | None = None
) -> list[PausedView]:
    """Pause every robot; just after a start, also those that are heard of in the next moments.

    name: of the request, from which the ids of its corrections follow. robots: only these.

    Raises:
        Problem: one of the robots that were named is unknown, or was not heard of yet.
        StoreError: not all of it could be kept; the same again is safe.
    """
    for robot in robots or ():
        parts.desk.find(robot)
    pausing: dict[str, asyncio.Task[PausedView]] = {}

    def begin(names: Iterable[str]) -> None:
        for robot in names:
            pausing[robot] = asyncio.create_task(_pause(parts, robot, said, name))

    while True:
        online, silent = _split(parts, pausing, robots)
        begin(online)
        if silent:
            await _answered(pausing.values(), parts.settings.delivery.answer_s)
            begin(silent)
        if parts.desk.settled or robots is not None:
            break
        await asyncio.sleep(LOOK_S)
    await _answered(pausing.values())
    return [pausing[robot].result() for robot in sorted(pausing)]


def _split(
    parts: Parts, known: Container[str], wanted: Collection[str] | None
) -> tuple[list[str], list[str]]:
    """The robots beyond those that are known: those that are online, and those that are not."""
    online, silent = list[str](), list[str]()
    for robot in parts.watch.names():
        presence, _ = parts.watch.presence(parts.watch.look(robot).heard_ns)
        if robot not in known and (wanted is None or robot in wanted):
            (online if presence is Presence.ONLINE else silent).append(robot)
    return online, silent


async def _answered(
    tasks: Collection[asyncio.Task[PausedView]], timeout_s: float | None = None
) -> None:
    if tasks:  # To wait for none is an error.
        await asyncio.wait(tasks, timeout=timeout_s)


async def _pause(parts: Parts, robot: str, said: Utterance, name: str) -> PausedView:
    """Say it; where no episode is known yet to say it of, as soon as one is."""
    end = asyncio.get_running_loop().time() + parts.settings.delivery.answer_s
    while True:
        try:
            return _show(parts, await parts.desk.accept(robot, said, _id(name, robot)))
        except Problem as problem:
            if problem.name != "no-episode" or asyncio.get_running_loop().time() > end:
                return PausedView(robot=robot, status=Status.REFUSED, reason=problem.detail)
        await asyncio.sleep(LOOK_S)


def _show(parts: Parts, entry: Entry) -> PausedView:
    robot, reason = entry.correction.robot, entry.reason
    if entry.status is Status.PENDING:
        presence, age_s = parts.watch.presence(parts.watch.look(robot).heard_ns)
        silent = "" if presence is Presence.ONLINE else f", {presence} for {age_s:.0f} s"
        reason = f"no receipt yet{silent}"
    shown = show_correction(parts, entry)
    return PausedView(robot=robot, status=entry.status, reason=reason, correction=shown)


def _id(name: str, robot: str) -> str:
    """The same for the same request and robot."""
    digest = hashlib.sha256(f"{name}\n{robot}".encode()).hexdigest()
    return f"pause-{digest[:24]}"
