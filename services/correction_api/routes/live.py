"""The WebSocket of the page: states as JSON texts, pictures as binary messages."""

import asyncio
from functools import partial
from typing import Annotated

import structlog
from fastapi import APIRouter, WebSocket, WebSocketDisconnect
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from services.correction_api.bell import Bell
from services.correction_api.live import Client, Slot, View
from services.correction_api.parts import Parts
from services.correction_api.routes import PartsDep
from services.correction_api.show import event, show_help, show_learner, show_robot
from shared.messages.message import Id

MAX_VIEWS = 128
SUBPROTOCOL = "hld"

router = APIRouter()
log = structlog.get_logger()


class Wanted(BaseModel):
    """One camera of one robot."""

    model_config = ConfigDict(extra="forbid")

    robot: Id
    camera: Id


class Look(BaseModel):
    """What a page sends: the cameras that it looks at from now on, and no others."""

    model_config = ConfigDict(extra="forbid")

    watch: Annotated[list[Wanted], Field(max_length=MAX_VIEWS)]


@router.websocket("/live")
async def live(socket: WebSocket, parts: PartsDep) -> None:
    asked = socket.scope.get("subprotocols", [])
    await socket.accept(SUBPROTOCOL if SUBPROTOCOL in asked else None)
    dropped = parts.metrics.live_dropped
    client = Client(Bell(asyncio.get_running_loop()), lambda kind: dropped.labels(kind).inc())
    parts.live.join(client)
    _greet(parts, client)
    tasks = [
        asyncio.create_task(_send(socket, client)),
        asyncio.create_task(_receive(socket, client, parts)),
    ]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        parts.live.leave(client)
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


async def _receive(socket: WebSocket, client: Client, parts: Parts) -> None:
    try:
        while True:
            _look(await socket.receive_text(), client, parts)
    except (WebSocketDisconnect, KeyError):  # KeyError: a binary message, which nobody sends.
        return


def _look(text: str, client: Client, parts: Parts) -> None:
    try:
        look = Look.model_validate_json(text)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        detail = f'send {{"watch": [{{"robot": …, "camera": …}}]}}: {first["msg"]}'
        client.offer(Slot("problem"), event("problem", lambda: {"detail": detail}))
        return
    parts.live.look(client, (View(wanted.robot, wanted.camera) for wanted in look.watch))
