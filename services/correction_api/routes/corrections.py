"""Corrections: taken, and read back."""

from typing import Annotated

from fastapi import APIRouter, Query, Response
from pydantic import BaseModel, ConfigDict, Field

from services.correction_api import examples
from services.correction_api.hindsight import find_correction
from services.correction_api.parts import Parts
from services.correction_api.problems import Problem, described
from services.correction_api.routes import KeyDep, PartsDep, PersonDep, named, signed
from services.correction_api.show import show_correction
from services.correction_api.store.log import Entry, Status
from services.correction_api.topic import current
from services.correction_api.utterance import Utterance
from services.correction_api.views import CorrectionPage, CorrectionView
from shared.messages.message import Id

MAX_PAGE = 200

router = APIRouter(tags=["corrections"])


class HistoryQuery(BaseModel):
    """robot, episode: only theirs. cursor: `next` of the page before."""

    model_config = ConfigDict(extra="forbid")

    robot: Id | None = None
    episode: Id | None = None
    limit: Annotated[int, Field(ge=1, le=MAX_PAGE)] = 50
    cursor: Annotated[str | None, Field(pattern=r"^[0-9]{1,18}$")] = None


@router.post(
    "/robots/{robot}/corrections",
    summary="Say what the robot shall do instead, that it was right, or what was wrong before",
    status_code=201,
    response_model=CorrectionView,
    responses={
        201: examples.answered(
            examples.CORRECTION,
            "On disk, and in force since receipt.step; or `kept`, about an episode that is over",
        ),
        202: examples.answered(
            examples.PENDING,
            "On disk; the robot has not answered yet, and is asked until it does or time runs out",
        )
        | {"model": CorrectionView},
        **described(400, 403, 404, 413, 415, 422, 503),
        409: examples.refused(
            "refused",
            "Refused as things stand; what is current is named",
            "episode ep-5f1b of robot-1 is over; the current one is ep-5f1c",
            current={"episode": "ep-5f1c", "step": 64, "command": "pick up the tomato"},
        ),
    },
)
async def correct(
    parts: PartsDep,
    person: PersonDep,
    robot: str,
    said: Utterance,
    response: Response,
    idempotency_key: KeyDep = None,
) -> CorrectionView:
    _check_length(said, parts.settings.text_characters)
    entry = await parts.desk.accept(robot, _signed(said, person), named(said.id, idempotency_key))
    if entry.status in (Status.REFUSED, Status.EXPIRED):
        raise _refusal(parts, entry)
    if entry.status is Status.PENDING:
        response.status_code = 202
    return show_correction(parts, entry)


@router.get(
    "/corrections/{correction}",
    summary="One correction, and what became of it",
    responses={
        200: examples.answered(examples.CORRECTION, "The correction"),
        **described(404, 422, 503),
    },
)
def correction(parts: PartsDep, correction: str) -> CorrectionView:
    return show_correction(parts, find_correction(parts.log, correction))


@router.get(
    "/corrections",
    summary="What was said, the newest first",
    responses={
        200: examples.answered(examples.CORRECTIONS, "One page of it"),
        **described(422, 503),
    },
)
def corrections(parts: PartsDep, query: Annotated[HistoryQuery, Query()]) -> CorrectionPage:
    before = int(query.cursor) if query.cursor else None
    entries = parts.log.page(query.robot, query.episode, query.limit, before)
    full = len(entries) == query.limit
    return CorrectionPage(
        corrections=[show_correction(parts, entry) for entry in entries],
        next=str(entries[-1].sequence) if full else None,
    )


def _check_length(said: Utterance, limit: int) -> None:
    if said.text and len(said.text) > limit:
        detail = f"text: {len(said.text)} characters are too many; at most {limit}"
        raise Problem(422, "invalid", "The request is not valid", detail)


def _signed(said: Utterance, person: str | None) -> Utterance:
    """What was said, by whoever's token came with it."""
    author = said.author if "author" in said.model_fields_set else None
    name = signed(person, author)
    return said.model_copy(update={"author": name}) if name else said


def _refusal(parts: Parts, entry: Entry) -> Problem:
    robot = entry.correction.robot
    now = current(parts.watch.look(robot)) if robot in parts.watch.names() else None
    title = "The robot refused" if entry.status is Status.REFUSED else "The robot never answered"
    return Problem(
        409,
        str(entry.status),
        title,
        entry.reason,
        correction=entry.correction.id,
        current=now,
    )
