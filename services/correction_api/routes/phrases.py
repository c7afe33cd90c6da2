"""Phrases: what a robot could be told, and what it would make of some words; nothing is obeyed."""

from typing import Annotated

from fastapi import APIRouter, Query
from pydantic import BaseModel, ConfigDict

from services.correction_api import examples
from services.correction_api.parts import Parts
from services.correction_api.phrases import Commands, Understood
from services.correction_api.problems import described, unavailable
from services.correction_api.routes import PartsDep
from services.correction_api.show import known_phrases
from services.correction_api.utterance import Words
from shared.errors import HldError
from shared.messages.message import ID_PATTERN
from shared.messages.phrase import PhraseAnswer

router = APIRouter(tags=["robots"])


class ScopeQuery(BaseModel):
    """anywhere: not in the scene as it is, but whatever a scene may hold, as is meant of the past;
    then another robot with the same low level may answer."""

    model_config = ConfigDict(extra="forbid")

    anywhere: bool = False


class PhraseQuery(BaseModel):
    """text: what somebody thinks of saying. anywhere: as in `ScopeQuery`."""

    model_config = ConfigDict(extra="forbid")

    text: Words
    anywhere: bool = False


@router.get(
    "/robots/{robot}/commands",
    summary="The commands that the robot knows and could do in its scene",
    responses={
        200: examples.answered(examples.COMMANDS, "The commands"),
        **described(404, 422, 503),
    },
)
def commands(parts: PartsDep, robot: str, query: Annotated[ScopeQuery, Query()]) -> Commands:
    if query.anywhere and ID_PATTERN.match(robot):  # It may be away for long.
        told = parts.lexicon.understood(robot, None)
    else:
        parts.desk.find(robot)
        told = _asked(parts, robot)
    if told is None:  # Away, or between two episodes: what is known is known all along.
        return Commands(robot=robot, commands=known_phrases(parts, robot), asked=False)
    return Commands(robot=robot, commands=told.commands, asked=True)


@router.get(
    "/robots/{robot}/phrase",
    summary="What the robot would make of a phrase, without being told it",
    responses={
        200: examples.answered(examples.UNDERSTOOD, "As which command it is read, or why not"),
        **described(404, 422, 503),
    },
)
def phrase(parts: PartsDep, robot: str, query: Annotated[PhraseQuery, Query()]) -> Understood:
    answer = _read(parts, robot, query)
    return Understood(
        robot=robot,
        text=query.text,
        step=answer.step,
        known=answer.known,
        means=answer.means,
        refused=answer.refused,
        nearest=answer.nearest,
    )


def _read(parts: Parts, robot: str, query: PhraseQuery) -> PhraseAnswer:
    if query.anywhere and ID_PATTERN.match(robot):  # It may be away for long.
        if answer := parts.lexicon.understood(robot, query.text):
            return answer
        raise unavailable("no-answer", "No robot says", "no robot with this low level answers")
    parts.desk.find(robot)
    try:
        return parts.lexicon.ask(robot, query.text)
    except HldError as error:
        raise unavailable("no-answer", "The robot does not say", str(error)) from None


def _asked(parts: Parts, robot: str) -> PhraseAnswer | None:
    try:
        return parts.lexicon.ask(robot, None)
    except HldError:
        return None
