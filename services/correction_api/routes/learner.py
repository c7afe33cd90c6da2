"""The learner, and how often the robots succeed."""

from typing import Annotated

from fastapi import APIRouter, Query
from pydantic import BaseModel, ConfigDict, Field

from services.correction_api import examples
from services.correction_api.problems import described
from services.correction_api.routes import PartsDep
from services.correction_api.show import show_learner
from services.correction_api.views import EpisodePage, LearnerView, TallyView
from shared.messages.message import Id

MAX_PAGE = 200

router = APIRouter(tags=["learner"])


class EpisodeQuery(BaseModel):
    """robot: only its episodes. cursor: `next` of the page before."""

    model_config = ConfigDict(extra="forbid")

    robot: Id | None = None
    limit: Annotated[int, Field(ge=1, le=MAX_PAGE)] = 50
    cursor: Annotated[str | None, Field(pattern=r"^[0-9]{1,18}$")] = None


@router.get(
    "/learner",
    summary="What the learner has and does, and the newest policy version",
    response_model_exclude_none=True,
    responses={200: examples.answered(examples.LEARNER, "The learner"), **described(503)},
)
def learner(parts: PartsDep) -> LearnerView:
    return show_learner(parts)


@router.get(
    "/episodes",
    summary="Episodes that ended, the newest first, and the success of each version",
    responses={
        200: examples.answered(examples.EPISODES, "One page of them"),
        **described(422, 503),
    },
)
def episodes(parts: PartsDep, query: Annotated[EpisodeQuery, Query()]) -> EpisodePage:
    before = int(query.cursor) if query.cursor else None
    rows = parts.episodes.page(query.robot, query.limit, before)
    return EpisodePage(
        episodes=[episode for _, episode in rows],
        tally=[TallyView.model_validate(entry._asdict()) for entry in parts.episodes.tally()],
        next=str(rows[-1][0]) if len(rows) == query.limit else None,
    )
