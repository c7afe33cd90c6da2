"""`python -m services.learner`: the learner, until Ctrl-C or SIGTERM."""

import json
from pathlib import Path
from typing import Annotated, Optional

import typer

from services.learner import build
from services.learner.config import LearnerSettings
from shared.config import load_or_exit
from shared.errors import ConfigError, HldError
from shared.service import Stop, run_command
from shared.telemetry import set_up


def main(
    config: Annotated[
        Optional[Path], typer.Option(help="TOML file with a table [learner].")
    ] = None,
    sets: Annotated[
        Optional[list[str]], typer.Option("--set", help="One setting, such as round.episodes=40.")
    ] = None,
    data: Annotated[
        Optional[Path], typer.Option(help="Folder of the run; all that is kept lies in it.")
    ] = None,
) -> None:
    """Collect what robots did and people said, and turn it into better versions."""
    own = [f"data={json.dumps(str(data))}"] if data else []
    settings = load_or_exit(LearnerSettings, "learner", file=config, sets=[*own, *(sets or [])])
    log = set_up("learner", settings.log_level)
    log.info("settings", **settings.model_dump(mode="json"))
    stop = Stop().on_signals()
    try:
        with build.learner(settings) as learner:
            learner.run(stop)
    except HldError as error:
        log.error("the learner ends", reason=str(error))
        raise typer.Exit(2 if isinstance(error, ConfigError) else 1) from None
    log.info("the learner ended")


if __name__ == "__main__":
    run_command(main)
