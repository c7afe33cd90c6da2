"""Me: under which name whoever asks is known here."""

from typing import Annotated

from fastapi import APIRouter
from pydantic import Field

from services.correction_api import examples
from services.correction_api.problems import described
from services.correction_api.routes import PersonDep
from services.correction_api.views import View
from shared.messages.message import Id

router = APIRouter(tags=["people"])


class MeView(View):
    """Who asks: the one whose token came. null: tokens have no names here, so say who you are."""

    person: Annotated[Id | None, Field(examples=["anna"])]


@router.get(
    "/me",
    summary="Whose token it is; null where tokens have no names, or none is needed",
    responses={200: examples.answered({"person": "anna"}, "Who asks"), **described(401)},
)
async def me(person: PersonDep) -> MeView:
    return MeView(person=person)
