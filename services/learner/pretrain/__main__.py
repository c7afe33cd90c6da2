"""`hld pretrain`: demonstrations and both levels from nothing, with progress, stop and resume."""

import multiprocessing
import os
from concurrent.futures import ProcessPoolExecutor
from contextlib import closing
from pathlib import Path
from typing import Annotated

import torch
import typer
from rich.console import Console

from services.learner.pretrain.figures import examine
from services.learner.pretrain.scale import SCALES
from services.learner.pretrain.stages import Pretraining
from shared.errors import HldError, nearest
from shared.evaluation.pool import begin_worker
from shared.progress import Bars

app = typer.Typer(add_completion=False)


@app.command()
def main(
    out: Annotated[
        Path,
        typer.Option(file_okay=False, help="Folder of stages and checkpoints; resumed if there."),
    ],
    scale: Annotated[str, typer.Option(help="small: minutes, to try it; full: hours.")] = "full",
    seed: Annotated[int, typer.Option(min=0, max=99, help="Of scenes, noise and weights.")] = 0,
    workers: Annotated[int, typer.Option(min=1, help="Processes that make data.")] = 2,
) -> None:
    """Make the demonstrations, train both levels, and write their checkpoints to OUT.

    Ctrl-C stops; the same command goes on with the stage that was under way.
    """
    if scale not in SCALES:
        raise typer.BadParameter(f"no scale {scale!r}{nearest(scale, SCALES)}")
    console = Console()
    os.environ["OMP_NUM_THREADS"] = "1"  # The processes share the cores; see also below.
    torch.set_num_threads(1)
    out.mkdir(parents=True, exist_ok=True)
    try:
        _pretrain(out, scale, seed, workers, console)
    except KeyboardInterrupt:
        console.print(f"stopped; the same command goes on in {out}")
        raise typer.Exit(130) from None
    except HldError as error:
        console.print(f"pretrain: {error}", style="red")
        raise typer.Exit(1) from None


def _pretrain(out: Path, scale: str, seed: int, workers: int, console: Console) -> None:
    spawn = multiprocessing.get_context("spawn")
    with (
        closing(Bars(console)) as bars,
        ProcessPoolExecutor(workers, mp_context=spawn, initializer=begin_worker) as pool,
    ):
        try:
            run = Pretraining(out, SCALES[scale], seed, pool, bars)
            low_level = run.low_level()
            lessons = run.demonstrations(low_level)
            high_level = run.high_level(lessons, low_level)
            run.replay(lessons)
            examine(run, low_level, high_level)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            for child in multiprocessing.active_children():
                child.terminate()  # A piece of practice takes minutes, and would be thrown away.
            raise
    console.print(f"checkpoints: {out}/low_level, {out}/high_level, {out}/demonstrations")


if __name__ == "__main__":
    app()
