"""The ear: gives utterances, one after another, to the recogniser beside this process."""

import asyncio
import json
import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

import structlog

from services.correction_api.config import SpeechSettings
from services.correction_api.problems import Problem, unavailable
from services.correction_api.speech.engines import KINDS
from services.correction_api.speech.hear import Recognition

COMMAND = (sys.executable, "-m", "services.correction_api.speech")
BROKEN = (OSError, ValueError, asyncio.IncompleteReadError, TimeoutError)
log = structlog.get_logger()


class Ear:
    """Event loop's thread only. The recogniser starts when it is first needed, and again after a
    fall; a queue of `settings.waiting` stands before it, and who comes beyond is sent away."""

    def __init__(self, settings: SpeechSettings, kinds: Sequence[str] = tuple(KINDS)) -> None:
        """kinds: the engines that count as there; fewer than all in tests."""
        self._settings = settings
        self._kinds = {name: KINDS[name] for name in kinds}
        self._turn = asyncio.Lock()
        self._waiting = 0
        self._process: asyncio.subprocess.Process | None = None
        self._warming: asyncio.Task[None] | None = None
        self.failed: dict[str, str] = {}

    @property
    def engines(self) -> tuple[str, ...]:
        """The engines that can be used."""
        there = (name for name, kind in self._kinds.items() if kind.installed)
        return tuple(name for name in there if self._settings.enabled and name not in self.failed)

    def check(self) -> None:
        """Refuse what can't be heard now, before anything of it is read.

        Raises:
            Problem: 503, there is no engine, or too many wait.
        """
        if not self.engines:
            raise unavailable("no-speech", "Speech is not recognised here", self.reason, 60)
        if self._waiting >= self._settings.waiting:
            detail = f"{self._waiting} utterances wait already; say it again, or type it"
            raise unavailable("busy", "Too many speak at once", detail)

    @property
    def reason(self) -> str:
        """Why nothing can be heard, and what to do; empty where something can."""
        if self.engines:
            return ""
        if not self._settings.enabled:
            return "set speech.enabled to true to have speech recognised"
        if self.failed:
            return "; ".join(f"{name} does not start: {why}" for name, why in self.failed.items())
        return f"no engine is installed: {KINDS['pocketsphinx'].install}, then start this again"

    def warm(self) -> None:
        """Start the recogniser, since somebody may speak soon."""
        idle = self._warming is None or self._warming.done()
        if self.engines and idle and self._process is None:
            self._warming = asyncio.create_task(self._warm())

    async def hear(self, pcm: bytes, commands: Sequence[str]) -> Recognition:
        """What was said.

        pcm: samples as `engines.Sound`, little-endian.

        Raises:
            Problem: 503, as in `check`, or the recogniser fell.
        """
        self.check()
        self._waiting += 1
        try:
            async with self._turn, asyncio.timeout(self._settings.hear_s):
                return await self._ask(pcm, commands)
        except asyncio.CancelledError:
            await self._end()  # Else its answer would be taken for that to the next one.
            raise
        except BROKEN as error:
            await self._end()
            log.warning("the recogniser fell", reason=repr(error))
            detail = "the recogniser fell and starts anew; say it again, or type it"
            raise unavailable("no-speech", "Speech was not recognised", detail) from error
        finally:
            self._waiting -= 1

    async def close(self) -> None:
        """End the recogniser."""
        if self._warming:
            self._warming.cancel()
            with suppress(asyncio.CancelledError):
                await self._warming
        await self._end()

    async def _warm(self) -> None:
        try:
            async with self._turn, asyncio.timeout(self._settings.hear_s):
                await self._started()
        except (Problem, *BROKEN) as error:
            log.warning("no recogniser", reason=repr(error))
            await self._end()

    async def _ask(self, pcm: bytes, commands: Sequence[str]) -> Recognition:
        process = await self._started()
        assert process.stdin
        head = json.dumps({"commands": [*commands], "bytes": len(pcm)})
        process.stdin.write(head.encode() + b"\n" + pcm)
        await process.stdin.drain()
        return Recognition.model_validate(await _answer(process))

    async def _started(self) -> asyncio.subprocess.Process:
        if self._process is None or self._process.returncode is not None:
            self._process = await asyncio.create_subprocess_exec(
                *COMMAND,
                stdin=asyncio.subprocess.PIPE,
                stdout=asyncio.subprocess.PIPE,
                env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
                start_new_session=True,  # Ctrl+C is for the service, which closes this one.
            )
            told = await _answer(self._process)
            self.failed = {name: str(why) for name, why in told["failed"].items()}
            log.info("the recogniser is ready", **told)
        if not self.engines:
            raise unavailable("no-speech", "Speech is not recognised here", self.reason, 60)
        return self._process

    async def _end(self) -> None:
        process, self._process = self._process, None
        if process and process.returncode is None:
            with suppress(ProcessLookupError):
                process.kill()
            await process.wait()


async def _answer(process: asyncio.subprocess.Process) -> Any:
    assert process.stdout
    return json.loads(await process.stdout.readuntil(b"\n"))
