"""Client: the correction API as the oracle uses it; it waits out whatever is down."""

import asyncio
from typing import Any

import httpx
import structlog

from services.oracle.config import OracleSettings
from services.oracle.seen import Seen, parse
from shared.errors import HldError, RefusedError

PAUSES_S = (0.1, 0.2, 0.5, 1.0, 2.0)
TIMEOUT_S = 10.0
log = structlog.get_logger()


class GoneError(HldError):
    """The API knows no such robot (any more, or not yet)."""


class OverError(RefusedError):
    """What was said is about an episode that is over; there is nothing to say about it."""


class Client:
    """Asks until it is answered: a restart of the API is only a pause. retries: how often."""

    def __init__(self, settings: OracleSettings) -> None:
        token = settings.token
        self._wait_s = settings.wait_s
        self.retries = 0
        self._http = httpx.AsyncClient(
            base_url=settings.url.rstrip("/") + "/api/v1/",
            headers={"Authorization": f"Bearer {token.get_secret_value()}"} if token else {},
            timeout=httpx.Timeout(TIMEOUT_S, read=TIMEOUT_S + settings.wait_s),
            limits=httpx.Limits(max_connections=None),
        )

    async def robots(self) -> list[str]:
        """The names of all robots."""
        answer = await self._ask("GET", "robots")
        return [robot["robot"] for robot in answer.json()["robots"]]

    async def decision(
        self, robot: str, after: str | None, wait_s: float | None = None
    ) -> Seen | None:
        """The newest decision that is not `after`; None when there is none in time.

        Raises:
            GoneError: the API knows no such robot.
        """
        query: dict[str, Any] = {"wait_s": self._wait_s if wait_s is None else wait_s}
        if after is not None:
            query["after"] = after
        answer = await self._ask("GET", f"robots/{robot}/decision", params=query)
        if answer.status_code == 404:
            raise GoneError(answer.json()["detail"])
        return None if answer.status_code == 204 else parse(answer.content)

    async def asks(self, robot: str) -> bool:
        """Whether a robot asks for help, within what the fleet may ask."""
        answer = await self._ask("GET", "help")
        return any(call["robot"] == robot for call in answer.json()["asking"])

    async def say(self, robot: str, body: dict[str, Any]) -> str:
        """Say something under the id in `body`; what became of it: "in force" or "pending".

        Raises:
            OverError: the episode is over. RefusedError: the robot or the API said no.
        """
        answer = await self._ask("POST", f"robots/{robot}/corrections", json=body)
        if answer.status_code < 400:
            return str(answer.json()["status"])
        problem = answer.json()
        current = problem.get("current")
        if current is not None and current.get("episode") != body["episode"]:
            raise OverError(problem["detail"])
        raise RefusedError(problem["detail"])

    async def status(self, name: str) -> str:
        """What has become of what was said under this id; "unknown" when it was never kept."""
        answer = await self._ask("GET", f"corrections/{name}")
        return str(answer.json()["status"]) if answer.status_code == 200 else "unknown"

    async def close(self) -> None:
        """Ask nothing more."""
        await self._http.aclose()

    async def _ask(self, method: str, path: str, **content: Any) -> httpx.Response:
        tries = 0
        while True:
            try:
                answer = await self._http.request(method, path, **content)
                if answer.status_code < 500:
                    return answer
                reason = f"status {answer.status_code}"
            except httpx.TransportError as error:
                reason = repr(error)
            if tries % len(PAUSES_S) == 0:
                log.info("the API does not answer", path=path, reason=reason)
            await asyncio.sleep(PAUSES_S[min(tries, len(PAUSES_S) - 1)])
            tries += 1
            self.retries += 1
