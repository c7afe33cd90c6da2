"""Robots: what they do now, and the decision that waits for somebody's word."""

import asyncio
from typing import Annotated

from fastapi import APIRouter, Query, Response
from pydantic import BaseModel, ConfigDict, Field

from services.correction_api import examples
from services.correction_api.bell import wait
from services.correction_api.parts import Parts
from services.correction_api.problems import described
from services.correction_api.routes import PartsDep
from services.correction_api.show import show_robot
from services.correction_api.views import Robots, RobotView
from shared.messages.decision import Decision

MAX_WAIT_S = 60.0

router = APIRouter(tags=["robots"])


class DecisionQuery(BaseModel):
    """after: the decision that you know already. wait_s: how long to wait for another one."""

    model_config = ConfigDict(extra="forbid")

    after: Annotated[str | None, Field(max_length=64, examples=["ep-5f1c-3"])] = None
    wait_s: Annotated[float, Field(ge=0, le=MAX_WAIT_S, allow_inf_nan=False)] = 20.0


@router.get(
    "/robots",
    summary="All robots that ever gave a sign of life",
    responses={200: examples.answered({"robots": [examples.ROBOT]}, "The robots, by name")},
)
async def robots(parts: PartsDep) -> Robots:
    return Robots(robots=[show_robot(parts, name) for name in parts.watch.names()])


@router.get(
    "/robots/{robot}",
    summary="What one robot does now, who chose it, and what else was proposed",
    responses={200: examples.answered(examples.ROBOT, "The robot"), **described(404, 422, 503)},
)
async def robot(parts: PartsDep, robot: str) -> RobotView:
    parts.desk.find(robot)
    return show_robot(parts, robot)


@router.get(
    "/robots/{robot}/decision",
    summary="The newest decision, as soon as it is another one than `after`",
    response_model=Decision,
    responses={
        200: examples.answered(examples.DECISION, "The newest decision"),
        204: {"description": "No other one came within wait_s; ask again"},
        **described(404, 422, 503),
    },
)
async def decision(
    parts: PartsDep, robot: str, query: Annotated[DecisionQuery, Query()]
) -> Response:
    parts.desk.find(robot)
    found = await _next_decision(parts, robot, query.after, query.wait_s)
    if found is None:
        return Response(status_code=204)
    return Response(found.model_dump_json(), media_type="application/json")


async def _next_decision(
    parts: Parts, robot: str, after: str | None, wait_s: float
) -> Decision | None:
    deadline = asyncio.get_running_loop().time() + wait_s
    while True:
        rung = parts.bell.event
        newest = parts.watch.look(robot).decision
        if newest and newest.id != after:
            return newest
        left_s = deadline - asyncio.get_running_loop().time()
        if left_s <= 0 or parts.bell.silenced or not await wait(rung, left_s):
            return None
