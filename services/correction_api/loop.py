"""Serve: uvicorn on one event loop, until the end is asked for."""

import asyncio
from collections.abc import Callable

import structlog
import uvicorn
from fastapi import FastAPI

from services.correction_api.app import Opening, create_app
from services.correction_api.config import ApiSettings
from shared.service import Stop

GRACE_S = 3
LOOK_S = 0.1
log = structlog.get_logger()


async def serve(
    settings: ApiSettings,
    opening: Opening,
    stop: Stop,
    serving: Callable[[str], None],
) -> None:
    """Serve until `stop`; `serving` is told the address once somebody can connect."""
    app = create_app(settings, opening)
    server = uvicorn.Server(
        uvicorn.Config(
            app,
            host=settings.host,
            port=settings.port,
            ssl_certfile=settings.tls_certificate,
            ssl_keyfile=settings.tls_key,
            ws="websockets-sansio",  # It waits for slow readers instead of buffering for them.
            ws_per_message_deflate=False,  # Pictures are compressed already.
            ws_max_size=64 * 1024,
            timeout_graceful_shutdown=GRACE_S,
            proxy_headers=False,
            access_log=False,
            log_config=None,
        )
    )
    minding = asyncio.create_task(_mind(app, server, settings, stop, serving))
    try:
        await server.serve()
    finally:
        minding.cancel()


async def _mind(
    app: FastAPI,
    server: uvicorn.Server,
    settings: ApiSettings,
    stop: Stop,
    serving: Callable[[str], None],
) -> None:
    while not server.started:
        await asyncio.sleep(LOOK_S / 5)
    serving(address(server, settings))
    while not (stop or server.should_exit):
        await asyncio.sleep(LOOK_S)
    app.state.parts.bell.silence()  # Who waits for a decision must not hold up the end.
    server.should_exit = True


def address(server: uvicorn.Server, settings: ApiSettings) -> str:
    """Where the server listens, also when it was told to take a free port."""
    host, port = server.servers[0].sockets[0].getsockname()[:2]
    scheme = "https" if settings.secure else "http"
    return f"{scheme}://{f'[{host}]' if ':' in host else host}:{port}{settings.prefix}/"
