"""`python -m deploy.router`: the router process, until Ctrl-C or SIGTERM."""

from pathlib import Path
from typing import Annotated

import typer

from shared.config import load_or_exit
from shared.errors import ConfigError
from shared.service import Stop, run_command
from shared.telemetry import set_up
from shared.wire.link import RouterSettings
from shared.wire.router import Router


def main(
    config: Annotated[Path | None, typer.Option(help="TOML file with a [router] table.")] = None,
    sets: Annotated[
        list[str] | None, typer.Option("--set", help="KEY=VALUE over the file.")
    ] = None,
) -> None:
    """Carry messages between the services."""
    log = set_up("router")
    settings = load_or_exit(RouterSettings, "router", file=config, sets=sets or ())
    log.info("settings", **settings.model_dump(mode="json"))
    stop = Stop().on_signals()
    try:
        with Router(settings):
            stop.wait()
    except ConfigError as error:
        typer.echo(f"configuration: {error}", err=True)
        raise typer.Exit(2) from None


if __name__ == "__main__":
    run_command(main)
