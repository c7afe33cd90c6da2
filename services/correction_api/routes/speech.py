"""Speech: a few spoken words, and the command that they mean. Nothing is done by it: whoever asked
says the command as a correction."""

from typing import Annotated, Any

from fastapi import APIRouter, Query, Request
from pydantic import BaseModel, ConfigDict

from services.correction_api import examples
from services.correction_api.parts import Parts
from services.correction_api.problems import Problem, described, shorten
from services.correction_api.routes import PartsDep
from services.correction_api.show import known_phrases
from services.correction_api.speech.engines import KINDS, RATE_HZ
from services.correction_api.speech.hear import Recognition
from services.correction_api.views import EngineView, SpeechView
from shared.messages.message import Id

MEDIA_TYPE = f"audio/l16; rate={RATE_HZ}"
MAY_SAY = {"channels": "1", "endianness": "little-endian"}
BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "description": "16-bit samples of one channel, little-endian, without a header; a wave "
        "file becomes that by `sox say.wav -t raw -r 16000 -c 1 -b 16 -e signed-integer say.raw`",
        "content": {MEDIA_TYPE: {"schema": {"type": "string", "format": "binary"}}},
    }
}

router = APIRouter(tags=["speech"])


class SpeechQuery(BaseModel):
    """robot: whom it is said to; else the commands of the newest policy are listened for."""

    model_config = ConfigDict(extra="forbid")

    robot: Id | None = None


@router.get(
    "/speech",
    summary="Which speech is recognised here, or what to install for it",
    responses={200: examples.answered(examples.SPEECH, "The engines"), **described(404, 422, 503)},
)
async def speech(parts: PartsDep, query: Annotated[SpeechQuery, Query()]) -> SpeechView:
    commands = _commands(parts, query.robot)
    parts.ear.warm()
    return SpeechView(
        available=bool(parts.ear.engines),
        reason=parts.ear.reason,
        engines=[
            EngineView(engine=name, available=name in parts.ear.engines, install=kind.install)
            for name, kind in KINDS.items()
        ],
        media_type=MEDIA_TYPE,
        max_s=parts.settings.speech.max_s,
        commands=commands,
    )


@router.post(
    "/speech",
    summary="Recognise a command that was spoken; it is not sent to any robot",
    openapi_extra=BODY,
    responses={
        200: examples.answered(examples.RECOGNITION, "What was heard"),
        **described(404, 413, 415, 422, 503),
    },
)
async def hear(
    parts: PartsDep, query: Annotated[SpeechQuery, Query()], request: Request
) -> Recognition:
    _check_type(request.headers.get("content-type", ""))
    commands = _commands(parts, query.robot)
    parts.ear.check()
    pcm = await request.body()
    if not pcm or len(pcm) % 2:
        detail = f"{len(pcm)} bytes are no samples of 2 bytes each; send at least one, all whole"
        raise Problem(422, "invalid", "The request is not valid", detail)
    return await parts.ear.hear(pcm, commands)


def _commands(parts: Parts, robot: str | None) -> tuple[str, ...]:
    if robot is not None:
        parts.desk.find(robot)
        return known_phrases(parts, robot)
    robots = parts.watch.names()
    return tuple(dict.fromkeys(text for name in robots for text in known_phrases(parts, name)))


def _check_type(given: str) -> None:
    media_type, *parameters = (part.strip().lower() for part in given.split(";"))
    said = dict(part.partition("=")[::2] for part in parameters if part)
    right = MAY_SAY | {"rate": str(RATE_HZ)}
    if media_type == "audio/l16" and "rate" in said and said.items() <= right.items():
        return
    detail = (
        f"send 16-bit samples, {RATE_HZ} a second, one channel, little-endian, with the header "
        f"`Content-Type: {MEDIA_TYPE}`; it was {shorten(given)}"
    )
    raise Problem(415, "no-speech-type", "The body is no such sound", detail)
