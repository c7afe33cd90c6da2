"""Episodes afterwards: found by what they were like, and looked at decision by decision."""

from typing import Annotated

from fastapi import APIRouter, Query, Response
from pydantic import BaseModel, ConfigDict, Field

from services.correction_api import examples_after as examples
from services.correction_api.afterwards import EpisodeAccount
from services.correction_api.examples import answered
from services.correction_api.parts import Parts
from services.correction_api.problems import Problem, described, shorten
from services.correction_api.routes import PartsDep
from services.correction_api.show import show_correction
from services.correction_api.store.episodes import Filter, Found
from services.correction_api.views import EpisodePage, EpisodeView, TallyView
from shared.errors import nearest
from shared.messages.message import ID_PATTERN, Id
from shared.messages.observation import CAMERAS
from shared.messages.recording import MAX_DECISIONS, Recording, RecordingQuery, StillQuery

MAX_PAGE = 200
MAX_SAID = 500
SHOWN = 50  # ids among which the nearest one is looked for
FOREVER = "private, max-age=86400, immutable"  # A decision never changes.

router = APIRouter(tags=["episodes"])


class EpisodeQuery(BaseModel):
    """robot, task, version: only theirs. success: only those that succeeded, or that didn't.

    corrected: somebody said what would be right, or nobody did. doubt: the robot called for help,
        or didn't. cursor: `next` of the page before.
    """

    model_config = ConfigDict(extra="forbid")

    robot: Id | None = None
    task: Id | None = None
    version: Annotated[str | None, Field(pattern=r"^[0-9]{1,9}\.[0-9]{1,9}$")] = None
    success: bool | None = None
    corrected: bool | None = None
    doubt: bool | None = None
    limit: Annotated[int, Field(ge=1, le=MAX_PAGE)] = 50
    cursor: Annotated[str | None, Field(pattern=r"^[0-9]{1,18}$")] = None


class PartQuery(BaseModel):
    """first: the index of the first decision, `next` of the part before."""

    model_config = ConfigDict(extra="forbid")

    first: Annotated[int, Field(ge=0, le=10**9)] = 0
    limit: Annotated[int, Field(ge=1, le=MAX_DECISIONS)] = MAX_DECISIONS


@router.get(
    "/episodes",
    summary="Episodes that ended, the newest first, and the success of each version",
    responses={
        200: answered(examples.EPISODES, "One page of them"),
        **described(422, 503),
    },
)
def episodes(parts: PartsDep, query: Annotated[EpisodeQuery, Query()]) -> EpisodePage:
    before = int(query.cursor) if query.cursor else None
    wanted = Filter.model_validate(query.model_dump(exclude={"limit", "cursor"}))
    found = parts.episodes.page(wanted, query.limit, before)
    return EpisodePage(
        episodes=[_shown(one) for one in found],
        tally=[TallyView.model_validate(entry._asdict()) for entry in parts.episodes.tally()],
        tasks=parts.episodes.tasks(),
        next=str(found[-1].sequence) if len(found) == query.limit else None,
    )


@router.get(
    "/episodes/{episode}",
    summary="One episode: how it ended, what was said about it, when its robot asked for help",
    responses={200: answered(examples.ACCOUNT, "The episode"), **described(404, 422, 503)},
)
def episode(parts: PartsDep, episode: str) -> EpisodeAccount:
    found = parts.episodes.get(episode)
    entries = parts.log.page(None, episode, MAX_SAID, None)
    robot = found.episode.robot if found else _runs(parts, episode)
    if robot is None and entries:
        robot = entries[0].correction.robot
    if robot is None:
        raise _unknown(parts, episode)
    return EpisodeAccount(
        id=episode,
        robot=robot,
        episode=_shown(found) if found else None,
        corrections=[show_correction(parts, entry) for entry in reversed(entries)],
        more=len(entries) == MAX_SAID,
        calls=parts.episodes.calls(episode),
    )


@router.get(
    "/episodes/{episode}/decisions",
    summary="What the high level decided in it, and why it was asked; the learner tells",
    response_model=Recording,
    responses={200: answered(examples.RECORDING, "One part of them"), **described(404, 422, 503)},
)
def decisions(parts: PartsDep, episode: str, query: Annotated[PartQuery, Query()]) -> Recording:
    _check_id(parts, episode)
    wanted = RecordingQuery(episode=episode, first=query.first, limit=query.limit)
    return parts.archive.recording(wanted)


@router.get(
    "/episodes/{episode}/stills/{decision}/{camera}",
    summary="What a camera showed the high level at a decision, 64 pixels square",
    response_class=Response,
    responses={
        200: {"content": {"image/jpeg": {"example": "a JPEG file"}}, "description": "The picture"},
        **described(404, 422, 503),
    },
)
def still(parts: PartsDep, episode: str, decision: str, camera: str) -> Response:
    _check_id(parts, episode)
    if not ID_PATTERN.match(decision) or decision.rpartition("-")[0] != episode:
        detail = f"no decision {shorten(decision)} in {episode}; their ids are {episode}-NUMBER"
        raise Problem(404, "unknown-decision", "No decision has this id", detail)
    if camera not in CAMERAS:
        detail = f"no camera {shorten(camera)}{nearest(camera[:64], CAMERAS)}"
        raise Problem(404, "unknown-camera", "No such camera", detail)
    found = parts.archive.still(StillQuery(decision=decision, camera=camera))
    return Response(
        found.arrays["jpeg"].tobytes(),
        media_type="image/jpeg",
        headers={"Cache-Control": FOREVER, "X-Step": str(found.step)},
    )


def _shown(found: Found) -> EpisodeView:
    fields = dict(found.episode) | {"arrays": {}}
    return EpisodeView(**fields, calls=found.calls, taught=found.taught)


def _runs(parts: Parts, episode: str) -> str | None:
    """The robot that is about this episode now."""
    sights = ((name, parts.watch.look(name)) for name in parts.watch.names())
    return next((name for name, sight in sights if sight.episode == episode), None)


def _check_id(parts: Parts, episode: str) -> None:
    if not ID_PATTERN.match(episode):
        raise _unknown(parts, episode)


def _unknown(parts: Parts, episode: str) -> Problem:
    last = [one.episode.id for one in parts.episodes.page(Filter(), SHOWN, None)]
    detail = f"no episode {shorten(episode)}{nearest(episode[:64], last)}"
    return Problem(404, "unknown-episode", "No episode has this id", detail)
