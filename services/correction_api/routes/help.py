"""Help: the robots in doubt, for people who can't watch all of them."""

from fastapi import APIRouter

from services.correction_api import examples
from services.correction_api.problems import described
from services.correction_api.routes import PartsDep
from services.correction_api.show import show_help
from services.correction_api.views import HelpQueue

router = APIRouter(tags=["robots"])


@router.get(
    "/help",
    summary="The robots that ask for help, the most urgent first",
    responses={200: examples.answered(examples.HELP, "Who asks"), **described(503)},
)
def help(parts: PartsDep) -> HelpQueue:
    return show_help(parts)
