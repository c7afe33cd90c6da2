"""The one command: `hld up`, or one service at a time. Imports what it needs when it needs it."""

import os
from pathlib import Path
from typing import Annotated, Any, Optional

os.environ.setdefault("MUJOCO_GL", "egl")  # Before anything imports MuJoCo.

import typer

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    help="Robots run a hierarchical policy, people correct it in words, the high level learns.",
)

_SERVICES = {
    "router": ("deploy.router", "The bus: one router, every service a client of it."),
    "actor": ("services.actor", "Robots on the bus."),
    "learner": ("services.learner", "Keep corrections, fine-tune the high level, publish it."),
    "api": ("services.correction_api", "People on the bus: HTTP and a web page."),
    "token": ("services.correction_api.invite", "A token for a person who corrects."),
    "oracle": ("services.oracle", "A scripted person who corrects over HTTP."),
    "pretrain": ("services.learner.pretrain", "Demonstrations, and the first policies from them."),
    "evaluate": ("services.actor.judge", "Success on seeds that no correction came from."),
    "experiment": ("services.learner.experiments", "What the hierarchy can do, and what it costs."),
    "policy": ("services.learner.versions", "Versions of the high level that a learner keeps."),
    "review": ("services.learner.questions", "What people contradict each other about, settled."),
    "say": ("services.actor.say", "One phrase to the low level in one scene."),
}
_PASS = {"allow_extra_args": True, "ignore_unknown_options": True, "help_option_names": []}


def _become(module: str) -> Any:
    def command(context: typer.Context) -> None:
        import sys

        from shared.service import CALLED

        os.environ[CALLED] = context.command_path
        os.execv(sys.executable, [sys.executable, "-m", module, *context.args])

    return command


for _name, (_module, _help) in _SERVICES.items():
    app.command(_name, help=_help, context_settings=_PASS)(_become(_module))


@app.command()
def up(
    oracle: Annotated[bool, typer.Option(help="a scripted person corrects")] = False,
    robots: Annotated[int, typer.Option(min=1, max=64, help="each in a process of its own")] = 2,
    rounds: Annotated[int, typer.Option(min=0, help="end after so many rounds; 0: at Ctrl-C")] = 0,
    episodes: Annotated[int, typer.Option(min=0, help="episodes a round; 0: by corrections")] = 0,
    evaluate: Annotated[int, typer.Option(min=0, help="evaluation episodes a version")] = 0,
    gate: Annotated[
        int, typer.Option(min=0, help="scenes in which a candidate is tried; 0: labels judge alone")
    ] = 20,
    report: Annotated[
        Optional[Path], typer.Option(dir_okay=False, help="write the figures here, as JSON")
    ] = None,
    site: Annotated[str, typer.Option(help="settings file of the cell")] = "far",
    tasks: Annotated[str, typer.Option(help="taken in turn; all, unless some are named")] = "",
    pace: Annotated[Optional[str], typer.Option(help="real-time or lockstep")] = None,
    seed: Annotated[int, typer.Option(min=0, max=10_000)] = 0,
    port: Annotated[int, typer.Option(min=1, max=65535, help="of the page")] = 8000,
    router_port: Annotated[int, typer.Option(min=1, max=65535)] = 7447,
    data: Annotated[Path, typer.Option(help="stores, logs and versions")] = Path("runs/up"),
    fresh: Annotated[bool, typer.Option(help="begin anew: move what is in DATA aside")] = False,
    set_: Annotated[
        Optional[list[str]], typer.Option("--set", help="SERVICE.KEY=VALUE, such as learner.x=1")
    ] = None,
) -> None:
    """Start router, learner, API and robots on this machine; end them all at Ctrl-C."""
    from deploy.up import Plan, run
    from shared.workcell.tasks import TASKS

    plan = Plan(
        oracle=oracle,
        robots=robots,
        rounds=rounds,
        episodes=episodes,
        evaluate=evaluate,
        gate=gate,
        report=report,
        site=site,
        tasks=tuple(tasks.split(",")) if tasks else tuple(TASKS),
        pace=pace or ("lockstep" if oracle else "real-time"),
        seed=seed,
        port=port,
        router_port=router_port,
        data=data,
        fresh=fresh,
        sets=tuple(set_ or ()),
    )
    raise typer.Exit(run(plan))


if __name__ == "__main__":
    app()
