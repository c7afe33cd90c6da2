"""`python -m services.oracle`: a scripted person corrects robots until told to stop."""

import asyncio
from pathlib import Path
from typing import Annotated, Optional

import typer

from services.oracle.build import build
from services.oracle.config import OracleSettings
from services.oracle.loop import run
from shared.config import load_or_exit
from shared.service import Stop, run_command
from shared.telemetry import set_up


def main(
    config: Annotated[Optional[Path], typer.Option(help="TOML file, table [oracle]")] = None,
    set_: Annotated[Optional[list[str]], typer.Option("--set", help="KEY=VALUE")] = None,
) -> None:
    """A scripted person: corrects over HTTP, with a person's delays and mistakes."""
    settings = load_or_exit(OracleSettings, "oracle", file=config, sets=set_ or ())
    log = set_up("oracle", settings.log_level)
    log.info("settings", **settings.model_dump(mode="json"))
    counts = asyncio.run(run(build(settings), settings, Stop().on_signals()))
    log.info("ended", **counts)


if __name__ == "__main__":
    run_command(main)
