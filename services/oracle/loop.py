"""The oracle's loop: one attention for each robot that there is, counts in the log."""

import asyncio
from collections import Counter

import structlog

from services.oracle.attend import Attention
from services.oracle.client import Client
from services.oracle.config import OracleSettings
from shared.service import Stop

LOOK_S = 0.1
ROLL_CALL_S = 2.0
log = structlog.get_logger()


async def run(client: Client, settings: OracleSettings, stop: Stop) -> Counter[str]:
    """Attend to all robots until the end is asked for; what was said, counted."""
    counts: Counter[str] = Counter()
    tasks = [
        asyncio.create_task(_call_roll(client, settings, counts)),
        asyncio.create_task(_report(client, settings, counts)),
    ]
    try:
        while not stop and not any(task.done() for task in tasks):
            await asyncio.sleep(LOOK_S)
    finally:
        for task in tasks:
            task.cancel()
        results = await asyncio.gather(*tasks, return_exceptions=True)
        await client.close()
    for result in results:
        if isinstance(result, Exception):
            raise result
    return counts


async def _call_roll(client: Client, settings: OracleSettings, counts: Counter[str]) -> None:
    """Give each robot that turns up somebody who attends to it."""
    known: set[str] = set()
    async with asyncio.TaskGroup() as group:
        while True:
            for robot in await client.robots():
                if robot not in known and robot in (settings.robots or (robot,)):
                    known.add(robot)
                    log.info("attending", robot=robot)
                    group.create_task(Attention(robot, client, settings, counts).attend())
            await asyncio.sleep(ROLL_CALL_S)


async def _report(client: Client, settings: OracleSettings, counts: Counter[str]) -> None:
    while True:
        await asyncio.sleep(settings.report_s)
        log.info("so far", **counts, retries=client.retries)
