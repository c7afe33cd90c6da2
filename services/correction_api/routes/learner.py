"""The learner now."""

from fastapi import APIRouter

from services.correction_api import examples
from services.correction_api.problems import described
from services.correction_api.routes import PartsDep
from services.correction_api.show import show_learner
from services.correction_api.views import LearnerView

router = APIRouter(tags=["learner"])


@router.get(
    "/learner",
    summary="What the learner has and does, and the newest policy version",
    response_model_exclude_none=True,
    responses={200: examples.answered(examples.LEARNER, "The learner"), **described(503)},
)
def learner(parts: PartsDep) -> LearnerView:
    return show_learner(parts)
