"""`hld say`: put one phrase to the low level in one scene, and report what came of it."""

import json
import shlex
import sys
from pathlib import Path
from typing import Annotated, Any, Optional

import typer
from pydantic import ValidationError
from rich.console import Console

from shared.config import exit_misconfigured, make_folder
from shared.errors import ConfigError, HldError
from shared.service import run_command

HOLDING_STEPS = 240
"""Time enough to put down what a hand holds before something else is picked up."""


def main(
    phrase: Annotated[str, typer.Argument(help="what is said, such as 'grab the cheese'")],
    task: Annotated[str, typer.Option(help="whose scene it is")] = "sandwich",
    seed: Annotated[int, typer.Option(help="the scene, counted as in hld evaluate")] = 0,
    holding: Annotated[str, typer.Option(help="the thing that a hand holds at first")] = "",
    lead: Annotated[int, typer.Option(min=0, help="skills of the task done before")] = 0,
    site: Annotated[str, typer.Option(help="settings file of the cell")] = "lab",
    low_level: Annotated[str, typer.Option(help="checkpoint folder; the bundled one")] = "",
    steps: Annotated[int, typer.Option(min=1, max=10_000)] = HOLDING_STEPS,
    report: Annotated[
        Optional[Path], typer.Option(dir_okay=False, help="write what came of it here")
    ] = None,
) -> None:
    """One phrase, one scene: what was understood, or why it is refused, and what was done."""
    from shared.evaluation.phrase import Phrases, Said, Speaker, Trial
    from shared.evaluation.plan import evaluation_seed
    from shared.evaluation.scene import Setting

    try:
        scene = evaluation_seed(seed)
        setting = Setting(seed=scene, task=task, holding=holding, lead=lead)
        if not phrase.strip():
            raise ConfigError("say something, such as 'pick up the cheese'")
        if report:
            make_folder(report.parent)
        speaker = Speaker(Phrases(site=site, low_level=low_level))
        said: Said = speaker(Trial(setting=setting, phrase=phrase, steps=steps))
    except ValidationError as error:
        exit_misconfigured(
            "say", ConfigError(error.errors()[0]["msg"].removeprefix("Value error, "))
        )
    except HldError as error:
        exit_misconfigured("say", error)
    speaker.close()
    content: dict[str, Any] = {
        "schema": 1,
        "command": shlex.join(["hld", "say", *sys.argv[1:]]),
        "task": task,
        "seed": seed,
        "site": site,
        "holding": holding or None,
        "phrase": phrase,
        "refused": bool(said.refused),
        "reason": said.refused,
        "nearest": [near._asdict() for near in said.nearest],
        "achieved": said.achieved,
        "already": said.already,
        "done": list(said.done),
        "steps": said.steps,
    }
    if report:
        report.write_text(json.dumps(content, indent=2, ensure_ascii=False) + "\n")
    _show(content)


def _show(content: dict[str, Any]) -> None:
    console = Console()
    near = ", ".join(f"{one['command']} ({one['score']:.2f})" for one in content["nearest"])
    console.print(f"nearest: {near}", markup=False)
    if content["refused"]:
        console.print(f"refused: {content['reason']}", markup=False)
    else:
        nothing = "nothing, it was so before" if content["already"] else "nothing"
        done = content["achieved"] or nothing
        console.print(f"achieved: {done}, {content['steps']} steps", markup=False)


if __name__ == "__main__":
    run_command(main)
