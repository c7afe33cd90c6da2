"""Attend: watches one robot and says what a person would say, when a person would say it."""

import asyncio
import hashlib
import time
from collections import Counter
from typing import Any

import structlog

from services.oracle.client import Client, GoneError, OverError
from services.oracle.config import OracleSettings
from services.oracle.seen import Seen
from shared.errors import HldError, RefusedError
from shared.workcell.person import Kind, Verdict, held, judge, top

ABSENT_S = 1.0
log = structlog.get_logger()


class Attention:
    """One robot's person. counts: shared by all of them."""

    def __init__(
        self, robot: str, client: Client, settings: OracleSettings, counts: Counter[str]
    ) -> None:
        self._robot, self._client, self._settings = robot, client, settings
        self._counts = counts
        self._last: Seen | None = None
        self._attempt = 0
        self._status = ""

    async def attend(self) -> None:
        """Watch until cancelled."""
        while True:
            try:
                await self._next()
            except GoneError:
                await asyncio.sleep(ABSENT_S)
            except HldError as error:
                self._counts["unclear"] += 1
                log.warning("not understood", robot=self._robot, reason=str(error))
                await asyncio.sleep(ABSENT_S)

    async def _next(self) -> None:
        last = self._last
        seen = await self._client.decision(self._robot, last.id if last else None)
        if seen is not None:
            self._last, self._attempt, self._status = seen, 0, ""
            self._counts["decisions"] += 1
        elif last is not None and await self._unheard(last):
            seen, self._attempt = last, self._attempt + 1
        else:
            return
        if not await self._watches(seen):
            self._counts["unasked"] += 1
            if seen.awaits_verdict:
                await self._say(seen, Verdict(Kind.PASS), time.time_ns())
        elif seen.awaits_verdict:
            verdict = judge(seen, self._settings)
            if self._attempt and verdict.kind is Kind.RELEASE:
                verdict = Verdict(Kind.OVERRIDE, top(seen))  # Somebody else let go before.
            await self._say(seen, verdict, time.time_ns())
        else:
            await self._react(seen)

    async def _watches(self, seen: Seen) -> bool:
        """Who only comes when asked stays until what was said holds no longer."""
        if not self._settings.only_when_asked or held(seen):
            return True
        return seen.help is not None and await self._client.asks(self._robot)

    async def _unheard(self, last: Seen) -> bool:
        """The robot waits still, since the verdict was lost, refused, or too old when it came."""
        if not last.awaits_verdict:
            return False
        if self._status == "pending":
            self._status = await self._client.status(self._name(last))
        return self._status not in ("pending", "in force", "over")

    async def _react(self, seen: Seen) -> None:
        """In real time: speak after the reaction time, if there is something to say still.

        Who doesn't look lets a robot that asks for help wait in vain.
        """
        verdict, begun_ns = judge(seen, self._settings), time.time_ns()
        if verdict.missed:
            self._counts["missed"] += 1
        elif verdict.objects or seen.waits:
            await asyncio.sleep(self._settings.delay_s)
            newest = await self._client.decision(self._robot, None, 0) or seen
            again = judge(newest, self._settings)
            self._last = newest
            if again.objects or (newest.waits and not again.missed):
                await self._say(newest, again, begun_ns)
        elif verdict.kind is Kind.APPROVE and self._settings.approve:
            await self._say(seen, verdict, begun_ns)

    async def _say(self, seen: Seen, verdict: Verdict, begun_ns: int) -> None:
        if verdict.kind is Kind.APPROVE and self._settings.approve is False:
            verdict = Verdict(Kind.PASS)
        name = "missed" if verdict.missed else "wrong" if verdict.wrong else str(verdict.kind)
        try:
            body = self._body(seen, verdict, begun_ns)
            self._status = await self._client.say(self._robot, body)
        except RefusedError as error:
            self._status = "over" if isinstance(error, OverError) else "refused"
            self._counts["refused"] += 1
            log.info("refused", robot=self._robot, kind=verdict.kind, reason=str(error))
            return
        self._counts[name] += 1
        log.debug("said", robot=self._robot, kind=verdict.kind, text=verdict.text)

    def _body(self, seen: Seen, verdict: Verdict, begun_ns: int) -> dict[str, Any]:
        body: dict[str, Any] = {
            "id": self._name(seen),
            "kind": verdict.kind,
            "author": self._settings.author,
            "decision": seen.id,
            "episode": seen.episode,
            "seen_step": seen.step,
            "begun_ns": begun_ns,
            "delay_steps": self._settings.delay_steps if seen.awaits_verdict else 0,
        }
        if verdict.kind is Kind.OVERRIDE:
            body |= {"text": verdict.text, "hold_steps": self._settings.hold_steps}
        return body

    def _name(self, seen: Seen) -> str:
        """One id a decision and attempt, so that saying it twice is saying it once."""
        said = f"{self._settings.author} {seen.id} {self._attempt}"
        return f"oracle-{hashlib.sha256(said.encode()).hexdigest()[:16]}"
