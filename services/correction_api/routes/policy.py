"""Versions of the high level: how they came about, how they do, and what people decide."""

import asyncio
import time
from collections.abc import Mapping
from itertools import groupby

from fastapi import APIRouter, Response
from starlette.concurrency import run_in_threadpool

from services.correction_api import examples_after as examples
from services.correction_api.afterwards import (
    PolicyHistory,
    Progress,
    RoundView,
    RulingState,
    RulingView,
    VersionProgress,
    VersionView,
)
from services.correction_api.brought import brought
from services.correction_api.examples import answered, refused
from services.correction_api.parts import Parts
from services.correction_api.problems import Problem, described
from services.correction_api.routes import PartsDep, PersonDep, signed
from services.correction_api.rule import RulingBody, check, same
from shared.intervals import wilson
from shared.messages.lineage import Lineage, RulingTold, Share
from shared.messages.policy import Version
from shared.messages.ruling import Ruling

RULINGS = 200

router = APIRouter(tags=["learner"])


@router.get(
    "/policy",
    summary="Versions, rounds and rulings, as the learner keeps them, and what each round brought",
    responses={200: answered(examples.POLICY, "All of it"), **described(503)},
)
def policy(parts: PartsDep) -> PolicyHistory:
    lineage = parts.archive.lineage()
    alone = {Version.parse(name).number: share for name, share in _alone(parts).items()}
    return PolicyHistory(
        version=lineage.version,
        versions=[
            VersionView(
                **one.model_dump(exclude={"epoch"}),
                version=Version(one.epoch, one.number),
                in_force=one.number == lineage.version.number,
            )
            for one in lineage.versions
        ],
        rounds=[
            RoundView(**dict(one) | {"arrays": {}}, brought=brought(one, alone))
            for one in lineage.rounds
        ],
        rulings=_rulings(parts, lineage),
    )


@router.get(
    "/progress",
    summary="How each version does: success with intervals, corrections and human seconds",
    responses={200: answered(examples.PROGRESS, "As this service has seen it"), **described(503)},
)
def progress(parts: PartsDep) -> Progress:
    tally = parts.episodes.tally()
    spent, alone = parts.episodes.attention(), _alone(parts)
    named = {Version.parse(name) for name in alone} | {one.version for one in tally}
    versions = []
    for number, alike in groupby(sorted(named, key=_by_number), key=lambda one: one.number):
        version, *also = alike
        names = {str(one) for one in (version, *also)}
        counted = [one for one in tally if one.version.number == number]
        episodes = sum(one.episodes for one in counted)
        successes = sum(one.successes for one in counted)
        versions.append(
            VersionProgress(
                version=version,
                number=number,
                also=also,
                service=_share(successes, episodes) if episodes else None,
                alone=next((alone[name] for name in names if name in alone), None),
                corrections=sum(one.corrections for one in counted),
                human_s=round(sum(spent.get(name, 0.0) for name in names), 1),
            )
        )
    return Progress(versions=versions)


@router.post(
    "/policy/rulings",
    summary="Put in force what the gate held back, or go back to an earlier version",
    status_code=201,
    response_model=RulingView,
    responses={
        201: answered(examples.RULING, "On disk, and on its way to the learner, which can do it"),
        202: answered(examples.RULING, "On disk; no learner answers now, the next one does it")
        | {"model": RulingView},
        **described(400, 403, 413, 415, 422, 503),
        409: refused(
            "not-to-be-done",
            "The learner could not do this",
            "no version 7; possible: 0, 1",
        ),
    },
)
async def rule(
    parts: PartsDep, person: PersonDep, said: RulingBody, response: Response
) -> RulingView:
    signed(person, said.author)
    ruling = said.formulate(time.time_ns())
    if not await run_in_threadpool(check, ruling, parts.archive):
        response.status_code = 202
    kept = await asyncio.wrap_future(parts.rulings.append(ruling))
    if not same(kept, ruling):
        detail = f"{ruling.id} was decided before: {kept.verb}, {kept.reason}; choose another id"
        raise Problem(409, "id-used", "Another ruling has this id", detail)
    return RulingView(ruling=kept, state=RulingState.WAITING)


def _rulings(parts: Parts, lineage: Lineage) -> list[RulingView]:
    """What the learner knows, and after it what was decided here and is not there yet."""
    known = {told.ruling.id for told in lineage.rulings}
    here = [
        _on_its_way(ruling, waits)
        for ruling, waits in reversed(parts.rulings.page(RULINGS))
        if ruling.id not in known
    ]
    return [*map(_told, lineage.rulings), *here]


def _told(told: RulingTold) -> RulingView:
    state = RulingState.GIVEN
    if told.answered_ns is not None:
        state = RulingState.REFUSED if told.reason else RulingState.DONE
    return RulingView(ruling=told.ruling, state=state, made=told.made, why=told.reason)


def _on_its_way(ruling: Ruling, waits: str | None) -> RulingView:
    if waits:
        return RulingView(ruling=ruling, state=RulingState.REFUSED, why=waits)
    state = RulingState.GIVEN if waits is None else RulingState.WAITING
    return RulingView(ruling=ruling, state=state)


def _by_number(version: Version) -> tuple[int, int]:
    """Numbers go on when a learner takes over the store, whose epoch is a later one then."""
    return version.number, version.epoch


def _alone(parts: Parts) -> Mapping[str, Share]:
    return {
        name: Share(share=one.success, n=one.n, low=one.low, high=one.high)
        for name, one in parts.reports.evaluations().items()
    }


def _share(successes: int, n: int) -> Share:
    low, high = wilson(successes, n)
    return Share(share=round(successes / n, 4), n=n, low=round(low, 4), high=round(high, 4))
