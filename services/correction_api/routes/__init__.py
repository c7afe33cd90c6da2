"""The routes, thin: each reads a request, asks a part, and shows the answer."""

from typing import Annotated, cast

from fastapi import Depends
from starlette.requests import HTTPConnection

from services.correction_api.parts import Parts


def _parts(connection: HTTPConnection) -> Parts:
    return cast(Parts, connection.app.state.parts)


PartsDep = Annotated[Parts, Depends(_parts)]
