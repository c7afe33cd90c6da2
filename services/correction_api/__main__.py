"""`python -m services.correction_api`: serve the API and its page until told to stop."""

import asyncio
import sys
from functools import partial
from pathlib import Path
from typing import Annotated, Optional

import typer

from services.correction_api.build import opened
from services.correction_api.config import ApiSettings
from services.correction_api.loop import serve
from shared.config import load_or_exit
from shared.service import Stop, run_command
from shared.telemetry import set_up

SWITCH_S = 0.0005  # A busy thread must not keep a correction waiting for 5 ms.


def main(
    config: Annotated[Optional[Path], typer.Option(help="TOML file, table [api]")] = None,
    set_: Annotated[Optional[list[str]], typer.Option("--set", help="KEY=VALUE")] = None,
) -> None:
    """People on the bus: show the robots, take words, keep the log of what people said."""
    settings = load_or_exit(ApiSettings, "api", file=config, sets=set_ or ())
    log = set_up("correction-api", settings.log_level)
    log.info("settings", **settings.model_dump(mode="json"))
    stop = Stop().on_signals()
    sys.setswitchinterval(SWITCH_S)
    asyncio.run(
        serve(settings, partial(opened, settings), stop, lambda url: log.info("serving", url=url))
    )
    log.info("ended")


if __name__ == "__main__":
    run_command(main)
