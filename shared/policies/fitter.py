"""What every fit shares: settings, optimizer, rate, averaged weights, and a state that is kept.

A fit that was cut off goes on from what `keep` wrote, and trains nothing twice.
"""

import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated

import numpy as np
import torch
from pydantic import Field
from safetensors.torch import load_file, save_file
from torch import Tensor

from shared.policies.variation import Variation

AVERAGE = 0.98
WARM_STEPS = 20


class FitSettings(Variation):
    """How a round learns.

    steps: updates. batch: decisions in each. lr: the highest learning rate, then down a cosine.
    correction_share: part of each batch that is drawn from the corrections.
    frozen_encoder: leave the eyes as they are, and train only what is behind them. They look at
        every picture once, in a few variations, and not in each update.
    mind_rate: where the eyes learn, the share of `lr` by which what is behind them learns: what
        prompts want, and what is to be done about it. The text head isn't among that.
    retoned: share of the demonstrations that are shown in the tones of the corrections' pictures,
        where the eyes learn; see `tones`.
    half: compute in bfloat16; None: where the processor is made for it.
    """

    steps: Annotated[int, Field(ge=1, le=1_000_000)] = 400
    batch: Annotated[int, Field(ge=1, le=4096)] = 64
    lr: Annotated[float, Field(gt=0, le=1)] = 1e-3
    weight_decay: Annotated[float, Field(ge=0, le=1)] = 1e-3
    correction_share: Annotated[float, Field(ge=0, le=1)] = 0.5
    frozen_encoder: bool = False
    mind_rate: Annotated[float, Field(gt=0, le=1)] = 1.0
    retoned: Annotated[float, Field(ge=0, le=1)] = 0.0
    half: bool | None = None
    seed: Annotated[int, Field(ge=0)] = 0


class Mean:
    """A running mean of the last updates."""

    def __init__(self, least: float = 0.03) -> None:
        self.value, self._count, self._least = 0.0, 0, least

    def add(self, value: float) -> float:
        """The mean with `value` in it."""
        self._count += 1
        self.value += (value - self.value) * max(self._least, 1.0 / self._count)
        return self.value

    def state(self) -> tuple[float, float]:
        """What `restore` needs to go on."""
        return self.value, float(self._count)

    def restore(self, value: float, count: float) -> None:
        """Go on from what `state` gave."""
        self.value, self._count = value, int(count)


class Fitter:
    """Optimizer, learning rate and averaged weights of one fit.

    others: parameters that learn, too, and aren't averaged. frozen: those of the net that don't.
    slow: those that learn by `mind_rate`.
    """

    def __init__(
        self,
        net: torch.nn.Module,
        settings: FitSettings,
        others: Iterable[torch.nn.Parameter] = (),
        frozen: Iterable[torch.nn.Parameter] = (),
        slow: Iterable[torch.nn.Parameter] = (),
    ) -> None:
        kept, held = {id(part) for part in frozen}, {id(part) for part in slow}
        self._own = [part for part in net.parameters() if id(part) not in kept]
        self._average = [part.detach().clone() for part in self._own]
        self._trained = [*self._own, *others]
        groups = [
            {
                "params": [part for part in self._trained if (id(part) in held) is is_slow],
                "of": rate,
            }
            for is_slow, rate in ((False, 1.0), (True, settings.mind_rate))
        ]
        self._optimizer = torch.optim.AdamW(
            groups, lr=settings.lr, weight_decay=settings.weight_decay, fused=True
        )
        self._settings = settings
        net.train()
        self._net = net

    def update(self, loss: Tensor, step: int) -> None:
        """One step down the gradient; `step` counts from 0."""
        fall = 0.5 * (1 + np.cos(np.pi * step / self._settings.steps))
        rate = self._settings.lr * (0.02 + 0.98 * fall) * min(1.0, (step + 1) / WARM_STEPS)
        for group in self._optimizer.param_groups:
            group["lr"] = rate * group["of"]
        self._net.zero_grad()
        self._optimizer.zero_grad()
        loss.backward()  # type: ignore[no-untyped-call]
        torch.nn.utils.clip_grad_norm_(self._trained, 1.0)
        self._optimizer.step()
        keep = min(AVERAGE, (step + 1) / (step + 10))
        with torch.no_grad():
            torch._foreach_lerp_(self._average, list[Tensor](self._own), 1 - keep)

    def state(self) -> dict[str, Tensor]:
        """Weights, moments and means: what `restore` needs to go on as if nothing had been."""
        state = {f"average.{row}": part for row, part in enumerate(self._average)}
        for row, part in enumerate(self._trained):
            state[f"weight.{row}"] = part.detach()
            for name, moment in self._optimizer.state[part].items():
                state[f"{name}.{row}"] = moment
        return state

    def restore(self, state: dict[str, Tensor]) -> None:
        """Go on from what `state` gave."""
        moments = {name.split(".")[0] for name in state} - {"average", "weight"}
        with torch.no_grad():
            for row, part in enumerate(self._average):
                part.copy_(state[f"average.{row}"])
            for row, part in enumerate(self._trained):
                part.copy_(state[f"weight.{row}"])
                found = {
                    name: state[f"{name}.{row}"] for name in moments if f"{name}.{row}" in state
                }
                if found:
                    self._optimizer.state[part] = found

    def finish(self) -> None:
        """Put the averaged weights into the network."""
        with torch.no_grad():
            torch._foreach_copy_(list[Tensor](self._own), self._average)
        self._net.eval()


def keep(fitter: Fitter, done: int, file: Path, means: Sequence[Mean] = ()) -> None:
    """Write beside the file and move it there, so that it is always whole.

    done: updates made. means: what is told of them, to go on as well.
    """
    beside = file.with_name(f"unfinished-{file.name}")
    told = {
        f"told.{row}": torch.tensor(mean.state(), dtype=torch.float64)
        for row, mean in enumerate(means)
    }
    save_file({**fitter.state(), **told, "done": torch.tensor(done)}, beside)
    with beside.open("rb") as written:
        os.fsync(written.fileno())  # Else a machine that dies could leave the name and no content.
    beside.rename(file)


def resumed(fitter: Fitter, file: Path | None, means: Sequence[Mean] = ()) -> int:
    """Take up what was kept; how many updates it had made."""
    if file is None or not file.exists():
        return 0
    state = load_file(file)
    done = int(state.pop("done"))
    for row, mean in enumerate(means):
        mean.restore(*state.pop(f"told.{row}").tolist())
    fitter.restore(state)
    return done
