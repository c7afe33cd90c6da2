"""`hld up`: the whole loop on one machine, watched, evaluated and ended in good order."""

import os
import signal
import threading
import time
from datetime import UTC, datetime
from pathlib import Path
from types import FrameType
from typing import NamedTuple

from rich.console import Console
from rich.live import Live

from deploy.board import Board
from deploy.children import Family, sets
from deploy.judging import Judging
from deploy.ports import check_free
from deploy.report import Report
from shared.errors import HldError
from shared.workcell.site import load_site
from shared.workcell.tasks import task_named

POLL_S = 0.5
INTERRUPTED = 130  # As a shell says of Ctrl-C.
PERSONS_STEPS = 3000  # A person gets 60 s an episode in real time, unless they set another limit.
YIELD = 5  # Of who tries candidates beside robots that have to keep time.
PERSONS_HELP = {  # In real time robots say when they are in doubt or stuck, and go on meanwhile.
    "help__threshold": 0.6,
    "help__stuck_steps": 150,
    "help__per_hour": 0,
}
PLAIN_EVERY_S = 20.0  # How often a line goes out where no terminal can show a table.


class Plan(NamedTuple):
    """What `hld up` was asked for; see its options."""

    oracle: bool
    robots: int
    rounds: int
    episodes: int
    evaluate: int
    gate: int
    report: Path | None
    site: str
    tasks: tuple[str, ...]
    pace: str
    seed: int
    port: int
    router_port: int
    data: Path
    fresh: bool
    sets: tuple[str, ...] = ()

    def sets_for(self, service: str) -> list[str]:
        """What `--set SERVICE.KEY=VALUE` says about one service."""
        mine = [text.removeprefix(f"{service}.") for text in self.sets]
        return [
            part
            for text, own in zip(self.sets, mine, strict=True)
            if text != own
            for part in ("--set", own)
        ]


def run(plan: Plan) -> int:
    """Run until the rounds are done or somebody says stop; the exit code."""
    console = Console()
    try:
        check(plan, console)
        if plan.fresh and plan.data.exists():
            aside = f"{plan.data.name}-{datetime.now(UTC):%Y%m%d-%H%M%S}"
            plan.data.rename(plan.data.with_name(aside))
        plan.data.mkdir(parents=True, exist_ok=True)
    except HldError as error:
        console.print(f"hld up: {error}", style="red", markup=False)
        return 2
    stop = stop_on_signals()
    family = Family(plan.data / "logs")
    folder = plan.data / "evaluation"
    judging = Judging(folder, plan.site, plan.tasks, plan.evaluate, judge_options(plan))
    try:
        start(plan, family)
        done = watch(plan, family, judging, console, stop)
        return 0 if done or not plan.rounds else INTERRUPTED
    except HldError as error:
        console.print(f"hld up: {error}", style="red", markup=False)
        return 1
    finally:
        judging.close()
        killed = family.end()
        ended = "ended" if not killed else f"ended, but had to kill {', '.join(killed)}"
        console.print(f"{ended}; everything is kept in {plan.data}", markup=False)


def check(plan: Plan, console: Console) -> None:
    """Refuse what cannot work before anything is started.

    Raises:
        HldError: an option is wrong; the message says what would be right.
    """
    known = ("router", "actor", "learner", "api", "oracle")
    for text in plan.sets:
        if text.split(".")[0] not in known or "=" not in text:
            raise HldError(f"--set {text}: say SERVICE.KEY=VALUE with one of {', '.join(known)}")
    if plan.pace not in ("real-time", "lockstep"):
        raise HldError(f"--pace is real-time or lockstep, not {plan.pace!r}")
    if plan.rounds and not plan.oracle and plan.pace == "lockstep":
        raise HldError("lockstep waits for a verdict at each decision: add --oracle")
    load_site(plan.site)
    for task in plan.tasks:
        task_named(task)
    if plan.port == plan.router_port:
        raise HldError(f"--port and --router-port are both {plan.port}; they must differ")
    if plan.rounds and not plan.fresh and (plan.data / "learner").exists():
        console.print(f"going on with what is in {plan.data}; --fresh begins anew", markup=False)
    check_free("the page", plan.port)
    check_free("the router", plan.router_port)


def start(plan: Plan, family: Family) -> None:
    """Start every process; each waits by itself for what it needs."""
    bus = {"bus__connect": [f"tcp/127.0.0.1:{plan.router_port}"]}
    data = plan.data
    family.add("router", "deploy.router", *sets(port=plan.router_port), *plan.sets_for("router"))
    family.add(
        "learner",
        "services.learner",
        *sets(data=str(data / "learner"), seed=plan.seed, **learner_rounds(plan), **bus),
        *learner_gate(plan),
        *learner_labels(plan),
        *plan.sets_for("learner"),
    )
    family.add(
        "api",
        "services.correction_api",
        *sets(
            port=plan.port,
            database=str(data / "api" / "corrections.sqlite"),
            evaluations=str(data / "evaluation"),
            **bus,
        ),
        *plan.sets_for("api"),
    )
    for index in range(plan.robots):
        family.add(f"actor-{index + 1}", "services.actor", *actor_sets(plan, index), *sets(**bus))
    if plan.gate:
        family.add("evaluator", "services.actor", *evaluator_sets(plan), *sets(**bus))
    if plan.oracle:
        family.add(
            "oracle",
            "services.oracle",
            *sets(url=f"http://127.0.0.1:{plan.port}", seed=plan.seed),
            *plan.sets_for("oracle"),
        )


def learner_rounds(plan: Plan) -> dict[str, object]:
    """When the learner begins a round: by episodes when they were asked for."""
    rounds: dict[str, object] = {"round__max_rounds": plan.rounds}
    if plan.episodes:
        rounds |= {"round__episodes": plan.episodes, "round__corrections": 0, "round__after_s": 0}
    return rounds


def learner_gate(plan: Plan) -> list[str]:
    """What a candidate is tried in: what the robots do, without people."""
    if not plan.gate:
        return []
    trials = sets(
        gate__trials__episodes=plan.gate,
        gate__trials__site=plan.site,
        gate__trials__tasks=list(plan.tasks),
    )
    rollout = [part for part in plan.sets_for("actor") if part.startswith("rollout.")]
    return [*trials, *[word for part in rollout for word in ("--set", f"gate.trials.{part}")]]


def learner_labels(plan: Plan) -> list[str]:
    """A slow high level is to say sooner what was right later: as much as it is slow."""
    slow = [part for part in plan.sets_for("actor") if part.startswith("rollout.latency_steps=")]
    return [
        word
        for part in slow[-1:]
        for word in ("--set", f"labels.anticipate_steps={part.partition('=')[2]}")
    ]


def evaluator_sets(plan: Plan) -> list[str]:
    """The settings of the actor that tries candidates."""
    mine = sets(id="evaluator", mode="evaluation", data=str(plan.data / "evaluator"))
    if plan.pace == "real-time":
        mine += sets(nice=YIELD)
    low_level = [part for part in plan.sets_for("actor") if part.startswith("low_level=")]
    return [*mine, *[word for part in low_level for word in ("--set", part)]]


def actor_sets(plan: Plan, index: int) -> list[str]:
    """The settings of the actor of one robot."""
    lockstep = plan.pace == "lockstep"
    share = plan.episodes // plan.robots + (index < plan.episodes % plan.robots)
    return [
        *sets(
            id=f"actor-{index + 1}",
            robots=[f"robot-{index + 1}"],
            first_index=index,
            data=str(plan.data / f"actor-{index + 1}"),
            site=plan.site,
            tasks=list(plan.tasks),
            seed=plan.seed,
            pace=plan.pace,
            rollout__supervised=lockstep and plan.oracle,
            **({} if lockstep else {"rollout__max_steps": PERSONS_STEPS, **PERSONS_HELP}),
            episodes_per_version=share,
            wait_for_version_s=600 if plan.rounds else 90,
        ),
        *plan.sets_for("actor"),
    ]


def judge_options(plan: Plan) -> tuple[str, ...]:
    """Evaluations run what the robots run: their low level and their rollout."""
    options: list[str] = []
    for part in plan.sets_for("actor"):
        if part.startswith("low_level="):
            options += ["--low-level", part.partition("=")[2].strip('"')]
        elif part.startswith("rollout."):
            options += ["--set", part.removeprefix("rollout.")]
    return tuple(options)


def watch(
    plan: Plan, family: Family, judging: Judging, console: Console, stop: threading.Event
) -> bool:
    """Show what happens, evaluate each version as it appears, and end when the work is done.

    Returns whether it was; False when somebody said stop before.
    """
    done = False
    board = Board(f"http://127.0.0.1:{plan.port}", plan.data / "learner" / "versions")
    report = Report(plan.report, plan.tasks, plan.site, board, judging, plan.rounds)
    if plan.evaluate:
        judging.want("oracle", "oracle")
    with Live(console=console, auto_refresh=False, transient=False) as live:
        spoken = 0.0
        while not stop.wait(POLL_S):
            family.mind()
            board.refresh()
            if plan.evaluate:
                for made in board.versions():
                    judging.want(made.name, str(made.folder))
            if plan.rounds and len(board.versions()) > plan.rounds:
                family.retire(
                    "oracle", "actor", "evaluator"
                )  # Nothing more is to be learned from them.
                judging.processes = os.cpu_count() or 1
            report.write()
            if console.is_terminal:
                live.update(board.table(judging, family), refresh=True)
            elif time.monotonic() - spoken > PLAIN_EVERY_S:
                spoken = time.monotonic()
                print(board.line(judging), flush=True)
            if plan.rounds and (done := report.complete()):
                break
    report.write()
    console.print(board.version_table(judging))
    if report.path:
        whole = "report" if done or not plan.rounds else "report of what was done so far"
        console.print(f"{whole}: {report.path}, plot: {report.plot()}", markup=False)
    return done


def stop_on_signals() -> threading.Event:
    """Set at Ctrl-C or SIGTERM."""
    stop = threading.Event()

    def handle(number: int, frame: FrameType | None) -> None:
        del number, frame  # Unused.
        stop.set()

    signal.signal(signal.SIGINT, handle)
    signal.signal(signal.SIGTERM, handle)
    return stop
