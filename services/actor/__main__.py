"""`python -m services.actor`: run one actor process until it is told to stop."""

import os
import sys
from pathlib import Path
from typing import Annotated, Optional

import typer

from services.actor.config import ActorSettings
from shared.config import exit_misconfigured, load_or_exit
from shared.errors import HldError, PolicyError, WorkcellError
from shared.service import Stop, run_command
from shared.telemetry import set_up


def main(
    config: Annotated[Optional[Path], typer.Option(help="TOML file, table [actor]")] = None,
    set_: Annotated[Optional[list[str]], typer.Option("--set", help="KEY=VALUE")] = None,
) -> None:
    """Robots on the bus: roll out the hierarchy, obey corrections, take up new weights."""
    settings = load_or_exit(ActorSettings, "actor", file=config, sets=set_ or ())
    log = set_up("actor", settings.log_level)
    log.info("settings", **settings.model_dump(mode="json"))
    stop = Stop().on_signals()
    sys.setswitchinterval(0.0005)  # Else a busy loop delays a correction by 5 ms.

    if settings.mode == "evaluation":
        from services.actor import trials  # Late, as below.

        os.nice(settings.nice)
        try:
            trials.run(settings, stop)
        except HldError as error:
            exit_misconfigured("actor", error)
        log.info("ended")
        return

    from services.actor.build import Actor  # Late: torch and MuJoCo take seconds to import.
    from services.actor.loop import run

    try:
        actor = Actor(settings)
    except HldError as error:
        exit_misconfigured("actor", error)
    try:
        if not actor.refresh.wait(settings.wait_for_policy_s):
            log.warning("no learner announced a policy", running=str(actor.refresh.newest.version))
        run(
            actor.runners,
            settings.pace,
            settings.rollout.control_hz,
            actor.clock,
            stop,
            actor.wake,
            actor.throttle,
        )
    except (WorkcellError, PolicyError) as error:  # A task or a scene that the cell can't make.
        exit_misconfigured("actor", error)
    finally:
        actor.close()
    log.info("ended")


if __name__ == "__main__":
    run_command(main)
