"""Fits the low level to what the expert did in the practice: regression of action chunks."""

import copy
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn import functional as F

from services.learner.pretrain.practice import Steps
from shared.policies.geometry import Geometry, View
from shared.policies.low_net import CHUNK, JOINTS, VERBS, LowNet, Orders, squash
from shared.policies.precision import autocast
from shared.workcell import expert, layout, placing
from shared.workcell.kinematics import BASE_X
from shared.workcell.objects import BODY_NAMES, OBJECTS
from shared.workcell.skills import SKILLS

EXECUTED = 5
LATE_WEIGHT = 0.3
GRIP_WEIGHT = 0.5
DONE_WEIGHT = 0.1
AVERAGE = 0.999
PORTION = 4096


@dataclass(frozen=True)
class LowFitSettings:
    """steps: updates. rows: rows (a moment and an arm) of a batch. lr: the highest, then cosine."""

    steps: int
    rows: int = 1024
    lr: float = 1.5e-3
    last_lr: float = 5e-5
    seed: int = 0


class Rows:
    """The practice as rows of one arm each, seen and ready to be drawn from.

    Views are computed once and kept as float16, whose steps are far below what they encode.
    """

    def __init__(self, steps: Steps, geometry: Geometry, seed: int) -> None:
        self._steps = steps
        self.moments, self.arms = worth_learning(steps, np.random.default_rng(seed))
        portions = np.array_split(np.arange(len(self)), max(1, len(self) // PORTION))
        parts = [_packed(geometry(*self._senses(portion))) for portion in portions]
        self._tokens, self._valid, self._body, self._near = (
            torch.cat(kind) for kind in zip(*parts, strict=True)
        )
        self._orders = orders()

    def __len__(self) -> int:
        return len(self.moments)

    def _senses(self, rows: NDArray[np.int64]) -> tuple[Tensor, Tensor, Tensor]:
        moments = self.moments[rows]
        arrays = self._steps.proprioception[moments], self._steps.objects[moments], self.arms[rows]
        return tuple(torch.from_numpy(array) for array in arrays)  # type: ignore[return-value]

    def draw(self, rng: np.random.Generator, count: int) -> "Lot":
        """`count` rows with replacement."""
        rows = rng.integers(0, len(self), count)
        moments, arms = self.moments[rows], self.arms[rows]
        now, answers, weights = answers_of(self._steps, moments, arms)
        index = torch.from_numpy(rows)
        view = View(
            self._tokens[index].float(),
            self._valid[index],
            self._body[index].float(),
            self._near[index].float(),
            torch.from_numpy(now),
        )
        return lot_at(self._steps, moments, view, self._orders, (answers, weights))


class Lot(NamedTuple):
    """Rows of a batch. answers: [R, S, 7], the expert's targets; weights: [R, S]; done: [R] 1
    where the command is achieved."""

    view: View
    orders: Orders
    answers: Tensor
    weights: Tensor
    done: Tensor


def lot_at(
    steps: Steps,
    moments: NDArray[np.int64],
    view: View,
    known: Orders,
    answers: tuple[NDArray[np.float32], NDArray[np.float32]],
) -> Lot:
    """A batch of rows at these moments [R].

    known: the orders of all commands. answers: targets [R, S, 7] and weights [R, S].
    """
    commands = torch.from_numpy(steps.commands[moments].astype(np.int64))
    return Lot(
        view,
        Orders(*(part[commands] for part in known)),
        torch.from_numpy(answers[0]),
        torch.from_numpy(answers[1]),
        torch.from_numpy(steps.done[moments].astype(np.float32)),
    )


def _packed(view: View) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    return view.tokens.half(), view.valid, view.body.half(), view.near.half()


def worth_learning(
    steps: Steps, rng: np.random.Generator
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Moments and arms of all rows, by moment, but few of those in which an arm just rests."""
    moves = np.abs(steps.actions - steps.proprioception[:, :14]).reshape(-1, 2, 7)
    resting = (moves[:, :, :JOINTS].max(-1) < 0.012) & (moves[:, :, JOINTS] < 0.01)
    kept = ~resting | (rng.random(resting.shape) < 0.15)
    moments, arms = np.nonzero(kept)
    return moments, arms


def answers_of(
    steps: Steps, moments: NDArray[np.int64], arms: NDArray[np.int64]
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]:
    """Joints now [R, 6], the expert's next targets [R, S, 7], 1 within the run [R, S]."""
    ahead = np.minimum(moments[:, None] + np.arange(CHUNK), len(steps) - 1)
    columns = 7 * arms[:, None] + np.arange(7)
    answers = steps.actions[ahead[:, :, None], columns[:, None, :]]
    now = steps.proprioception[moments[:, None], columns[:, :JOINTS]]
    weights = (steps.runs[ahead] == steps.runs[moments][:, None]).astype(np.float32)
    return now, answers, weights


def measures() -> dict[str, Tensor]:
    """The cell's measures that the low level is told, see `Geometry`."""
    return {
        "sizes": torch.tensor([item.half_sizes_m for item in OBJECTS]),
        "round": torch.tensor([float(item.shape == "disc") for item in OBJECTS]),
        "block": torch.tensor([float(item.shape == "block") for item in OBJECTS]),
        "base_x": torch.tensor(BASE_X[1]),
        "plate_top": torch.tensor(layout.PLATE_TOP_M),
        "floor": torch.tensor(layout.BIN_FLOOR_M),
        "slot": torch.tensor(placing.SLOT_M),
        "spots": torch.tensor(placing.FREE_SPOTS),
        "tub_spots": torch.tensor(placing.TUB_SPOTS),
        "home": torch.tensor(expert.HOME),
    }


def orders() -> Orders:
    """The commands as the network reads them, [20] each."""
    verbs = [VERBS.index(skill.verb) for skill in SKILLS]
    things = [-1 if skill.object is None else BODY_NAMES.index(skill.object) for skill in SKILLS]
    return Orders(torch.tensor(verbs), torch.tensor(things))


def fit_low(
    net: LowNet,
    steps: Steps,
    settings: LowFitSettings,
    progress: Callable[[int, int, float], bool],
) -> LowNet:
    """Train `net` on; returns the average of the weights over the last updates.

    progress: told updates done, updates in all and the loss; False stops early.
    """
    torch.manual_seed(settings.seed)
    rng = np.random.default_rng(settings.seed)
    rows = Rows(steps, net.geometry, settings.seed)
    optimizer = torch.optim.AdamW(net.parameters(), lr=settings.lr, weight_decay=1e-3)
    average = copy.deepcopy(net)
    recent = 0.0
    for step in range(settings.steps):
        _set_rate(optimizer, settings, step)
        lot = rows.draw(rng, settings.rows)
        with autocast():
            motion = net(lot.view, lot.orders)
        moved = chunk_loss(motion.changes.float(), lot.view.now, lot.answers, lot.weights)
        told = F.binary_cross_entropy_with_logits(motion.done.float(), lot.done)
        loss = moved + DONE_WEIGHT * told
        optimizer.zero_grad()
        loss.backward()  # type: ignore[no-untyped-call]
        torch.nn.utils.clip_grad_norm_(net.parameters(), 1.0)
        optimizer.step()
        _follow(average, net, min(AVERAGE, step / (step + 10)))
        recent += (loss.item() - recent) * (1.0 if step == 0 else 0.02)
        if step % 50 == 0 and not progress(step, settings.steps, recent):
            break
    return average


def _follow(average: LowNet, net: LowNet, keep: float) -> None:
    """Move the average a little towards the weights."""
    with torch.no_grad():
        own, now = list[Tensor](average.parameters()), list[Tensor](net.parameters())
        torch._foreach_lerp_(own, now, 1 - keep)


def chunk_loss(changes: Tensor, now: Tensor, answers: Tensor, weights: Tensor) -> Tensor:
    """Absolute error of squashed joint changes plus cross entropy of the grippers.

    changes: [R, S, 7]; now: [R, 6]; answers: [R, S, 7]; weights: [R, S].
    """
    wanted = squash(answers[..., :JOINTS] - now.unsqueeze(1))
    off = F.smooth_l1_loss(changes[..., :JOINTS], wanted, beta=0.1, reduction="none").mean(-1)
    open_ = (answers[..., JOINTS] > 0.03).float()
    grip = F.binary_cross_entropy_with_logits(changes[..., JOINTS], open_, reduction="none")
    late = torch.where(torch.arange(CHUNK) < EXECUTED, 1.0, LATE_WEIGHT)
    scale = weights * late
    return ((off + GRIP_WEIGHT * grip) * scale).sum() / scale.sum()


def _set_rate(optimizer: torch.optim.Optimizer, settings: LowFitSettings, step: int) -> None:
    """A short warm-up, then down a cosine."""
    warm = min(1.0, (step + 1) / 100)
    fall = 0.5 * (1 + np.cos(np.pi * step / settings.steps))
    rate = settings.last_lr + (settings.lr - settings.last_lr) * fall
    for group in optimizer.param_groups:
        group["lr"] = rate * warm
