"""Errors as problem+json (RFC 9457): what is wrong, and what would be right."""

import json
from collections.abc import Iterable, Mapping, Sequence
from typing import Annotated, Any

from fastapi import FastAPI, HTTPException, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import Response
from pydantic import BaseModel, ConfigDict, Field
from starlette.exceptions import HTTPException as PlainException

from services.correction_api.store.writer import StoreError
from shared.errors import nearest
from shared.messages.message import ID_PATTERN

MEDIA_TYPE = "application/problem+json"
TYPE_PREFIX = "urn:hl-dagger:problem:"
SHOWN_CHARACTERS = 60
PATH_CHARACTERS = 200
ID_WORDS = "use lower-case letters, digits and '-', at most 64 characters"


class FieldProblem(BaseModel):
    """What is wrong with one field of a request."""

    field: str
    detail: str


class ProblemDetail(BaseModel):
    """An error that a program can tell by `type`, and a person can act upon by `detail`.

    errors: one line a field, when the request itself is wrong.
    current: what the robot is about now, when a correction came too late for it.
    correction: the id of the correction that was kept although the robot refused it.
    """

    model_config = ConfigDict(extra="allow")

    type: Annotated[str, Field(examples=[f"{TYPE_PREFIX}unknown-robot"])]
    title: Annotated[str, Field(examples=["No robot has this id"])]
    status: Annotated[int, Field(examples=[404])]
    detail: Annotated[
        str, Field(examples=["no robot 'robot-l'; nearest known: 'robot-1', 'robot-2'"])
    ]
    instance: str | None = None
    errors: list[FieldProblem] | None = None
    current: dict[str, Any] | None = None
    correction: str | None = None


class Problem(HTTPException):
    """Raised by a route or the gate; becomes a problem+json answer.

    name: ends the `type`; extensions: further members, as in `ProblemDetail`.
    FastAPI passes its own kind of exception on while it reads a body, and no other.
    """

    def __init__(
        self,
        status: int,
        name: str,
        title: str,
        detail: str,
        *,
        headers: Mapping[str, str] | None = None,
        **extensions: Any,
    ) -> None:
        super().__init__(status, detail, headers)
        self.name, self.title, self.extensions = name, title, extensions

    def response(self, instance: str) -> Response:
        """The answer; ASCII only, so that any text that came in can go out."""
        content = {
            "type": TYPE_PREFIX + self.name,
            "title": self.title,
            "status": self.status_code,
            "detail": self.detail,
            "instance": _clip(instance, PATH_CHARACTERS),
            **self.extensions,
        }
        return Response(
            json.dumps(content), self.status_code, headers=self.headers, media_type=MEDIA_TYPE
        )


def unavailable(name: str, title: str, detail: str, retry_after_s: int = 1) -> Problem:
    """503: it would work later."""
    return Problem(503, name, title, detail, headers={"Retry-After": str(retry_after_s)})


def described(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """What OpenAPI is to say of the errors of a route."""
    schema = {"$ref": "#/components/schemas/ProblemDetail"}
    reasons = {
        400: "The body is no JSON",
        401: "A token is needed",
        403: "The page comes from another origin, or the author is not whose token it is",
        404: "Not known; the nearest known is named",
        409: "Refused as things stand; what is current is named",
        413: "The body is too large",
        415: "The body is not of the type that this route takes",
        422: "A field is wrong; each is named, with what would be right",
        503: "Not now; Retry-After says when to try again",
    }
    return {
        status: {"description": reasons[status], "content": {MEDIA_TYPE: {"schema": schema}}}
        for status in statuses
    }


def install(app: FastAPI, known: Mapping[str, Iterable[str]]) -> None:
    """Make every error of `app` a problem+json.

    known: field names by place ("body", "query"), for the hint at an unknown one.
    """

    async def raised(request: Request, error: Exception) -> Response:
        return as_problem(error, known).response(request.url.path)

    for kind in (Problem, PlainException, RequestValidationError, StoreError, Exception):
        app.add_exception_handler(kind, raised)


def as_problem(error: Exception, known: Mapping[str, Iterable[str]]) -> Problem:
    """The problem that an exception stands for."""
    match error:
        case Problem():
            return error
        case RequestValidationError():
            return _invalid(error.errors(), known)
        case StoreError():
            return unavailable("storage", "Nothing was stored", str(error), 5)
        case PlainException():
            return _plain(error)
        case _:
            return Problem(500, "internal", "Internal error", "see the log of the service")


def _plain(error: PlainException) -> Problem:
    details = {
        400: "the body is no JSON object that can be read",
        404: "no such path; the routes are listed in api/v1/openapi.json",
        405: "this path is there, but not for this method",
    }
    detail = details.get(error.status_code, str(error.detail))
    title = str(error.detail)
    return Problem(error.status_code, "http", title, detail, headers=error.headers)


def _invalid(errors: Sequence[Any], known: Mapping[str, Iterable[str]]) -> Problem:
    if any(error["type"] == "json_invalid" for error in errors):
        return Problem(400, "no-json", "The body is no JSON", "the body is no JSON object")
    if any(error["loc"] == ("body",) and isinstance(error["input"], bytes) for error in errors):
        detail = "send a JSON object with the header `Content-Type: application/json`"
        return Problem(415, "no-json", "The body is no JSON", detail)
    fields = [_field(error, known) for error in errors]
    return Problem(
        422,
        "invalid",
        "The request is not valid",
        "; ".join(field.detail for field in fields),
        errors=[field.model_dump() for field in fields],
    )


def _field(error: Mapping[str, Any], known: Mapping[str, Iterable[str]]) -> FieldProblem:
    place, *path = (str(part) for part in error["loc"])
    name = ".".join(path) or place
    match error["type"]:
        case "extra_forbidden":
            detail = f"unknown field {shorten(name)}{nearest(name[:64], known.get(place, ()))}"
        case "missing":
            detail = f"{name} is missing"
        case "value_error":
            detail = f"{name}: {error['ctx']['error']}" if path else str(error["ctx"]["error"])
        case "string_pattern_mismatch" if error["ctx"]["pattern"] == ID_PATTERN.pattern:
            detail = f"{name}: {ID_WORDS}, not {shorten(error['input'])}"
        case _:
            detail = f"{name}: {error['msg']}, not {shorten(error['input'])}"
    return FieldProblem(field=_clip(name, SHOWN_CHARACTERS), detail=detail)


def shorten(value: Any) -> str:
    """What somebody sent, as an error may show it."""
    return _clip(repr(value), SHOWN_CHARACTERS)


def _clip(text: str, limit: int) -> str:
    return text if len(text) <= limit else text[: limit - 1] + "…"
