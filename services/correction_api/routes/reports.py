"""Measured reports of experiments, for the page of figures."""

from typing import Any

from fastapi import APIRouter

from services.correction_api import examples_after as examples
from services.correction_api.afterwards import ReportBrief, Reports
from services.correction_api.examples import answered
from services.correction_api.problems import described
from services.correction_api.routes import PartsDep

router = APIRouter(tags=["reports"])


@router.get(
    "/reports",
    summary="Which experiments were measured",
    responses={200: answered(examples.REPORTS, "All that there could be")},
)
def reports(parts: PartsDep) -> Reports:
    told = parts.reports.listed().items()
    return Reports(
        reports=[ReportBrief(name=name, measured=not hint, hint=hint) for name, hint in told]
    )


@router.get(
    "/reports/{name}",
    summary="What an experiment measured: horizon, replanning or transitions",
    responses={200: answered(examples.REPORT, "Its report.json"), **described(404, 422)},
)
def report(parts: PartsDep, name: str) -> dict[str, Any]:
    return parts.reports.experiment(name)
