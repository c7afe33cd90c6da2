"""Pause: one request that stops every robot, or those that it names."""

from fastapi import APIRouter

from services.correction_api import examples
from services.correction_api.pause import PauseBody, PauseView, pause_all
from services.correction_api.problems import described
from services.correction_api.routes import KeyDep, PartsDep, PersonDep, named, signed
from shared.messages.message import new_id

router = APIRouter(tags=["corrections"])


@router.post(
    "/pause",
    summary="Stop every robot at once, or some; it says of each whether it stands still",
    responses={
        200: examples.answered(examples.PAUSED, "What became of it, robot by robot"),
        **described(400, 403, 404, 413, 415, 422, 503),
    },
)
async def pause(
    parts: PartsDep,
    person: PersonDep,
    said: PauseBody = PauseBody(),
    idempotency_key: KeyDep = None,
) -> PauseView:
    author = signed(person, said.author if "author" in said.model_fields_set else None)
    name = named(said.id, idempotency_key) or new_id("stop")
    robots = await pause_all(parts, said.utterance(author), name, said.robots)
    return PauseView(id=name, robots=robots)
