"""For those who keep the service running: is it alive, is it ready, how is it doing."""

from fastapi import APIRouter, Response
from prometheus_client import CONTENT_TYPE_LATEST

from services.correction_api.problems import described, unavailable
from services.correction_api.routes import PartsDep

router = APIRouter(tags=["health"])


@router.get("/healthz", summary="The process answers")
async def healthz() -> dict[str, str]:
    return {"status": "alive"}


@router.get(
    "/readyz",
    summary="It reaches the bus, and the disk takes what is said",
    responses=described(503),
)
def readyz(parts: PartsDep) -> dict[str, str]:
    parts.log.probe()
    if not parts.bus.connected:
        endpoints = ", ".join(parts.settings.bus.connect)
        raise unavailable("no-bus", "The bus is not reached", f"no router answers at {endpoints}")
    return {"status": "ready"}


@router.get(
    "/metrics",
    summary="Figures for Prometheus",
    response_class=Response,
    responses={200: {"content": {"text/plain": {"example": "hldagger_robots 2.0\n"}}}},
)
def metrics(parts: PartsDep) -> Response:
    return Response(parts.metrics.render(), media_type=CONTENT_TYPE_LATEST)
