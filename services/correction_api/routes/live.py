"""The WebSocket of the page: states as JSON texts, pictures as binary messages."""

import asyncio
from functools import partial
from typing import Annotated, Self

import structlog
from fastapi import APIRouter, WebSocket, WebSocketDisconnect
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from services.correction_api.bell import Bell
from services.correction_api.live import Client, Slot, View
from services.correction_api.parts import Parts
from services.correction_api.people import speaker
from services.correction_api.routes import PartsDep, PersonDep
from services.correction_api.show import (
    event,
    show_help,
    show_learner,
    show_people,
    show_robot,
)
from shared.errors import RefusedError
from shared.messages.frame import Rate
from shared.messages.message import Id

MAX_VIEWS = 128
SUBPROTOCOL = "hld"
SILENT_S = 120.0
"""A page says every second that it is there, and every minute where its browser let it sleep."""

router = APIRouter()
log = structlog.get_logger()


class Wanted(BaseModel):
    """One camera of one robot. rate: full, or slow: about two pictures a second."""

    model_config = ConfigDict(extra="forbid")

    robot: Id
    camera: Id
    rate: Rate = Rate.FULL


class Look(BaseModel):
    """What a page sends: what is left out stays as it is.

    watch: the cameras that it looks at from now on, and no others.
    taken: how many messages it has taken in since it was opened; one that never says so gets
        everything as fast as its connection takes it. One that does is given up when it says
        nothing for two minutes: its network is gone.
    focus: the robot that its person has before them; null: none.
    author: who they are, where their token doesn't say so.
    """

    model_config = ConfigDict(extra="forbid")

    watch: Annotated[list[Wanted], Field(max_length=MAX_VIEWS)] | None = None
    taken: Annotated[int, Field(strict=True, ge=0, le=2**53)] | None = None
    focus: Id | None = None
    author: Id | None = None

    @model_validator(mode="after")
    def _check_said(self) -> Self:
        if not self.model_fields_set:
            raise ValueError("watch, taken, focus or author is needed")
        return self


@router.websocket("/live")
async def live(socket: WebSocket, parts: PartsDep, person: PersonDep) -> None:
    asked = socket.scope.get("subprotocols", [])
    await socket.accept(SUBPROTOCOL if SUBPROTOCOL in asked else None)
    dropped = parts.metrics.live_dropped
    bell = Bell(asyncio.get_running_loop())
    client = Client(bell, lambda kind: dropped.labels(kind).inc(), person)
    parts.live.join(client)
    _greet(parts, client)
    _tell_people(parts)
    tasks = [
        asyncio.create_task(_send(socket, client)),
        asyncio.create_task(_receive(socket, client, parts, person)),
    ]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        parts.live.leave(client)
        _tell_people(parts)
        for task in tasks:
            task.cancel()
        for ended in await asyncio.gather(*tasks, return_exceptions=True):
            if isinstance(ended, Exception) and not isinstance(ended, WebSocketDisconnect):
                log.error("a page was given up", reason=repr(ended))


def _greet(parts: Parts, client: Client) -> None:
    for name in parts.watch.names():
        client.offer(Slot("robot", name), event("robot", partial(show_robot, parts, name)))
    client.offer(Slot("help"), event("help", lambda: show_help(parts)))
    client.offer(Slot("learner"), event("learner", lambda: show_learner(parts)))


async def _send(socket: WebSocket, client: Client) -> None:
    """Send what waits, one after the other: a slow reader only lets its own queue fill up."""
    while True:
        rung = client.bell.event
        while (content := client.take()) is not None:
            if isinstance(content, bytes):
                await socket.send_bytes(content)
            else:
                await socket.send_text(content)
        await rung.wait()


async def _receive(socket: WebSocket, client: Client, parts: Parts, person: str | None) -> None:
    try:
        while True:
            async with asyncio.timeout(SILENT_S if client.counts else None):
                text = await socket.receive_text()
            _look(text, client, parts, person)
    except TimeoutError:
        await socket.close()
    except (WebSocketDisconnect, KeyError):  # KeyError: a binary message, which nobody sends.
        return


def _look(text: str, client: Client, parts: Parts, person: str | None) -> None:
    try:
        look = Look.model_validate_json(text)
        name = speaker(person, look.author)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        detail = f'send {{"watch": [{{"robot": …, "camera": …}}]}}: {first["msg"]}'
        client.offer(Slot("problem"), event("problem", lambda: {"detail": detail}))
        return
    except RefusedError as error:
        detail = str(error)
        client.offer(Slot("problem"), event("problem", lambda: {"detail": detail}))
        return
    if look.taken is not None:
        client.acknowledge(look.taken)
    if look.watch is not None:
        views = (View(wanted.robot, wanted.camera, wanted.rate) for wanted in look.watch)
        parts.live.look(client, views)
    before = client.name, client.focus
    client.name = name or client.name
    client.focus = look.focus if "focus" in look.model_fields_set else client.focus
    if before != (client.name, client.focus):
        _tell_people(parts)


def _tell_people(parts: Parts) -> None:
    parts.live.offer(Slot("people"), event("people", lambda: show_people(parts)))
