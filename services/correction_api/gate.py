"""The gate: what every request passes before any route sees it.

A page of somebody else's must not be able to command a robot: neither by a form, nor by a
WebSocket, nor by a host name of its own that it points at 127.0.0.1.
"""

from collections.abc import Iterable
from urllib.parse import urlsplit

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import RedirectResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from services.correction_api.config import ApiSettings, is_loopback
from services.correction_api.people import People
from services.correction_api.problems import Problem

MAX_BODY_BYTES = 64 * 1024
SPEECH = "/api/v1/speech"
SPEECH_BYTES_S = 32_000  # 16,000 samples a second of 2 bytes.
SAFE = ("GET", "HEAD", "OPTIONS")
OPEN = ("/healthz", "/readyz")
PERSON = "hl_dagger.person"
"""Key of the scope: the name of whoever has the token that came; None where tokens have none."""
POLICY = (
    "default-src 'self'; img-src 'self' blob: data:; object-src 'none'; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'"
)
HEADERS = {
    "Content-Security-Policy": POLICY,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
}


class Gate:
    """ASGI middleware: place, host, origin, token and size of a request; headers of its answer."""

    def __init__(self, app: ASGIApp, settings: ApiSettings) -> None:
        self._app, self._settings = app, settings
        self._people = People(settings.token, settings.people)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        scope = self._placed(scope)
        try:
            scope[PERSON] = self._check(scope)
        except Problem as problem:
            await problem.response(scope["path"])(scope, receive, _marked(send))
            return
        app = _to_folder if self._bare(scope) else self._app
        await app(scope, _limited(receive, self._limit(scope)), _marked(send))

    def _placed(self, scope: Scope) -> Scope:
        """The scope below the path prefix, whether a proxy took it off or left it."""
        prefix, path = self._settings.prefix, scope["path"]
        if prefix and path != prefix and not path.startswith(f"{prefix}/"):
            path = prefix + path
        return {**scope, "root_path": prefix, "path": path}

    def _bare(self, scope: Scope) -> bool:
        """A page is asked for by the prefix alone: relative links would lead past it."""
        prefix = self._settings.prefix
        page = scope["type"] == "http" and scope["method"] in ("GET", "HEAD")
        return bool(prefix) and page and scope["path"] == prefix

    def _check(self, scope: Scope) -> str | None:
        """Whose token it has, where tokens have names."""
        headers = Headers(scope=scope)
        self._check_host(headers)
        if scope["type"] == "websocket" or scope["method"] not in SAFE:
            self._check_origin(headers)
        person = self._recognize(scope, headers)
        length = headers.get("content-length", "0")
        limit = self._limit(scope)
        if not length.isdecimal() or int(length) > limit:
            raise _too_large(limit)
        return person

    def _limit(self, scope: Scope) -> int:
        """The bytes that a body may have: sound is larger than words."""
        if scope["path"].removeprefix(self._settings.prefix) == SPEECH:
            return int(self._settings.speech.max_s * SPEECH_BYTES_S)
        return MAX_BODY_BYTES

    def _check_host(self, headers: Headers) -> None:
        """Without a token, the name by which it is called must be this machine's."""
        host = urlsplit(f"//{headers.get('host', '')}").hostname or ""
        if self._people.guarded or is_loopback(host) or host in self._settings.hosts:
            return
        detail = f"{host!r} is no name of this service; use 127.0.0.1, or add it to `hosts`"
        raise Problem(403, "host", "Not under this name", detail)

    def _check_origin(self, headers: Headers) -> None:
        origin = headers.get("origin")
        if origin is None:
            return  # No browser.
        parts = urlsplit(origin)
        if parts.netloc == headers.get("host") or parts.hostname in self._settings.hosts:
            return
        detail = f"a page from {origin} may not do this; open the page of this service"
        raise Problem(403, "origin", "Another origin", detail)

    def _recognize(self, scope: Scope, headers: Headers) -> str | None:
        path = scope["path"].removeprefix(self._settings.prefix)
        if not (self._people.guarded and _guarded(path)):
            return None
        holder = self._people.find(_tokens(headers, scope.get("subprotocols", ())))
        if holder is None:
            raise Problem(
                401,
                "token",
                "A token is needed",
                "send the header `Authorization: Bearer TOKEN` with your token of this service",
                headers={"WWW-Authenticate": "Bearer"},
            )
        return holder.name


async def _to_folder(scope: Scope, receive: Receive, send: Send) -> None:
    """Send whoever asks for a folder without its slash there, by whatever name they came."""
    query = scope["query_string"].decode("latin-1")
    url = f"{scope['path']}/{'?' if query else ''}{query}"
    await RedirectResponse(url)(scope, receive, send)


def _guarded(path: str) -> bool:
    inner = path.removeprefix("/api/v1")
    return inner not in OPEN and (inner != path or inner == "/metrics")


def _tokens(headers: Headers, subprotocols: Iterable[str]) -> list[str]:
    """The tokens that were sent: by header, or as a subprotocol where a page can't set headers."""
    scheme, _, token = headers.get("authorization", "").partition(" ")
    found = [name.removeprefix("token.") for name in subprotocols if name.startswith("token.")]
    return [*found, token] if scheme.lower() == "bearer" else found


def _limited(receive: Receive, limit: int) -> Receive:
    """Count a body that did not say how long it is."""
    taken = 0

    async def limited() -> Message:
        nonlocal taken
        message = await receive()
        if message["type"] == "http.request":
            taken += len(message.get("body", b""))
            if taken > limit:
                raise _too_large(limit)
        return message

    return limited


def _marked(send: Send) -> Send:
    async def marked(message: Message) -> None:
        if message["type"] in ("http.response.start", "websocket.http.response.start"):
            MutableHeaders(scope=message).update(HEADERS)
        await send(message)

    return marked


def _too_large(limit: int) -> Problem:
    words = f"at most {limit} bytes; a command has at most 200 characters"
    sound = f"at most {limit} bytes, {limit / SPEECH_BYTES_S:g} s of speech; say it shorter"
    detail = words if limit == MAX_BODY_BYTES else sound
    return Problem(413, "too-large", "The body is too large", detail)
