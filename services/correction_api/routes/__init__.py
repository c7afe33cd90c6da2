"""The routes, thin: each reads a request, asks a part, and shows the answer."""

import hashlib
from typing import Annotated, cast

from fastapi import Depends, Header
from starlette.requests import HTTPConnection

from services.correction_api.gate import PERSON
from services.correction_api.parts import Parts
from services.correction_api.people import speaker
from services.correction_api.problems import Problem
from shared.errors import RefusedError
from shared.messages.message import ID_PATTERN

MAX_KEY = 255


def _parts(connection: HTTPConnection) -> Parts:
    return cast(Parts, connection.app.state.parts)


PartsDep = Annotated[Parts, Depends(_parts)]


def _person(connection: HTTPConnection) -> str | None:
    return cast("str | None", connection.scope.get(PERSON))


PersonDep = Annotated[str | None, Depends(_person)]
"""Whose token came with the request, where tokens have names."""

KeyDep = Annotated[
    str | None, Header(max_length=MAX_KEY, description="instead of `id` in the body")
]
"""The header `Idempotency-Key`."""


def signed(person: str | None, author: str | None) -> str | None:
    """Under which name something goes; None: nobody said one.

    Raises:
        Problem: it is not that of whoever's token came.
    """
    try:
        return speaker(person, author)
    except RefusedError as error:
        raise Problem(403, "author", "In somebody else's name", str(error)) from None


def named(given: str | None, key: str | None) -> str | None:
    """The client's own id: given in the body, or by the header (any text; hashed if need be).

    Raises:
        Problem: both are given, and differ.
    """
    if key is None:
        return given
    name = key if ID_PATTERN.match(key) else f"key-{hashlib.sha256(key.encode()).hexdigest()[:32]}"
    if given not in (None, name):
        detail = f"id is {given!r} but Idempotency-Key is {key!r}; give one, or the same twice"
        raise Problem(422, "invalid", "The request is not valid", detail)
    return name
