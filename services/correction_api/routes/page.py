"""The page and the list of routes: files read once, served with their hashes as ETags."""

import hashlib
from collections.abc import Mapping
from importlib.resources import files
from importlib.resources.abc import Traversable
from typing import NamedTuple

from fastapi import APIRouter, Request, Response

MEDIA_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
}


NAMED = {"": "index.html", "docs": "docs.html"}  # The others are asked for by their names.


class Asset(NamedTuple):
    """One file of the page."""

    content: bytes
    media_type: str
    etag: str


def make_router() -> APIRouter:
    """Routes for all files of the page; `/` is `index.html`, `/docs` is `docs.html`."""
    router = APIRouter(include_in_schema=False)
    assets = dict(_read(files("services.correction_api.page"), ""))
    for name in assets:
        router.add_api_route(f"/{name}", _serving(assets, name), methods=["GET", "HEAD"])
    for path, name in NAMED.items():
        router.add_api_route(f"/{path}", _serving(assets, name), methods=["GET", "HEAD"])
    missing = _serving(assets, "missing.html", 404)  # After the others: any other name of a page.
    router.add_api_route("/{name}.html", missing, methods=["GET", "HEAD"])
    return router


def _read(folder: Traversable, path: str) -> Mapping[str, Asset]:
    found: dict[str, Asset] = {}
    for entry in folder.iterdir():
        suffix = "." + entry.name.rpartition(".")[2]
        if entry.is_dir():
            found |= _read(entry, f"{path}{entry.name}/")
        elif suffix in MEDIA_TYPES:
            content = entry.read_bytes()
            etag = f'"{hashlib.sha256(content).hexdigest()[:16]}"'
            found[path + entry.name] = Asset(content, MEDIA_TYPES[suffix], etag)
    return found


def _serving(assets: Mapping[str, Asset], name: str, status: int = 200):  # type: ignore[no-untyped-def]
    async def serve(request: Request) -> Response:
        asset = assets[name]
        headers = {"ETag": asset.etag, "Cache-Control": "no-cache"}
        if request.headers.get("If-None-Match") == asset.etag:
            return Response(status_code=304, headers=headers)
        return Response(asset.content, status, media_type=asset.media_type, headers=headers)

    return serve
