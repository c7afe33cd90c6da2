"""The FastAPI application: routes under `/api/v1`, the page beside them."""

from collections.abc import AsyncIterator, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager

from fastapi import FastAPI

from services.correction_api import problems
from services.correction_api.config import ApiSettings
from services.correction_api.gate import Gate
from services.correction_api.parts import Parts
from services.correction_api.pause import PauseBody
from services.correction_api.routes import (
    corrections,
    episodes,
    health,
    help,
    learner,
    live,
    me,
    pause,
    phrases,
    policy,
    reports,
    robots,
    speech,
)
from services.correction_api.routes.page import make_router
from services.correction_api.rule import RulingBody
from services.correction_api.utterance import Utterance

API = "/api/v1"
ABOUT = """Watch robots work and say what is wrong in words.

A correction is on disk before it is acknowledged, is taken to its robot until the robot's receipt
says since which step it is in force (or why it was refused), and goes to the learner. The robot
obeys at its next control step. The WebSocket `/api/v1/live` pushes states and pictures: send
`{"watch": [{"robot": "robot-1", "camera": "angle", "rate": "full"}]}` (or "slow": two a second),
read `{"type": "robot" | "decision" | "correction" | "episode" | "help" | "learner" | "people", …}`
and binary pictures (2 bytes: length of the JSON head, the head with robot, step and camera, then
the JPEG).
"""

Opening = Callable[[], AbstractAsyncContextManager[Parts]]


def create_app(settings: ApiSettings, opening: Opening) -> FastAPI:
    """The application; `opening` makes its parts when it starts, and closes them when it ends."""

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        async with opening() as parts:
            app.state.parts = parts
            yield

    app = FastAPI(
        title="hl-dagger correction API",
        summary="Robots, their commands, and what people say about them",
        description=ABOUT,
        version="1",
        openapi_url=f"{API}/openapi.json",
        docs_url=None,  # They would load scripts from elsewhere; the page has its own.
        redoc_url=None,
        lifespan=lifespan,
    )
    queries = (
        robots.DecisionQuery,
        corrections.HistoryQuery,
        episodes.EpisodeQuery,
        episodes.PartQuery,
        phrases.PhraseQuery,
        speech.SpeechQuery,
    )
    fields = {name for query in queries for name in query.model_fields}
    bodies = (Utterance, RulingBody, PauseBody)
    said = {name for body in bodies for name in body.model_fields}
    problems.install(app, {"body": said, "query": fields})
    for module in (
        robots, phrases, help, corrections, pause, speech, episodes, policy, reports, learner, me,
        live, health,
    ):  # fmt: skip
        app.include_router(module.router, prefix=API)
    app.include_router(health.router, include_in_schema=False)
    app.include_router(make_router())
    app.add_middleware(Gate, settings=settings)
    return app
