"""What the low level can see at a glance: the scene as each arm sees it, in tokens.

Each arm looks at the world from its own base, so that one network serves both. R rows (a
moment and an arm), O = 15 objects, K = 48 tokens: the objects, the plate, the quarters of bin and
tub, the free spots of both tables, home. A thing is described by its measures, not by its name.
Lengths in m, angles in rad. A pure function of proprioception and object poses.
"""

from typing import NamedTuple

import torch
from torch import Tensor, nn

from shared.policies.tokens import OBJECTS, Scene, arms, gripped_by

PLATE, BIN, TUB = 15, 16, 17
QUARTERS = 4
THING, ON_PLATE, IN_BIN, IN_TUB, SPOT, HOME = range(6)
"""Kinds of tokens."""

AWAY_M = 5.0
"""Where an absent thing is put, from any arm: no rule takes it for near."""
MEASURES = (
    *("sizes", "round", "block", "base_x", "plate_top", "floor", "slot", "spots", "tub_spots"),
    "home",
)


class View(NamedTuple):
    """tokens [R, K, TOKEN_FEATURES]; valid [R, K] bool: what is there; body [R, BODY_FEATURES];
    near [R, O]: share of each object in being the one at the tool; now [R, 6]: measured joints."""

    tokens: Tensor
    valid: Tensor
    body: Tensor
    near: Tensor
    now: Tensor


class Geometry(nn.Module):
    """Fixed knowledge of the cell's measures as buffers, so that it travels with the weights.

    sizes: [O, 3] half of width, length and height. round, block: [O] 1 for a disc, for a block.
    base_x: distance of the bases from the middle. plate_top, floor: heights of the plate's top and
        of the floor in bin and tub. slot: offset of a quarter from its middle.
    spots, tub_spots: [*, 2] x to the arm's own side, and y, of free spots without and with a tub.
    home: [2, 3] where each tool rests, world frame.
    """

    sizes: Tensor
    round: Tensor
    block: Tensor
    base_x: Tensor
    plate_top: Tensor
    floor: Tensor
    slot: Tensor
    spots: Tensor
    tub_spots: Tensor
    home: Tensor

    def __init__(self, measures: dict[str, Tensor]) -> None:
        super().__init__()
        for name in MEASURES:
            self.register_buffer(name, measures[name].to(torch.float32))

    @property
    def kinds(self) -> Tensor:
        """[K] int64: the kind of each token."""
        counts = (OBJECTS, 1, QUARTERS, QUARTERS, len(self.spots) + len(self.tub_spots), 1)
        return torch.repeat_interleave(torch.arange(6), torch.tensor(counts))

    def forward(self, proprioception: Tensor, objects: Tensor, arm: Tensor) -> View:
        """proprioception [R, 22], objects [R, 18, 9], arm [R] int64: 0 left, 1 right."""
        sign = 1.0 - 2.0 * arm.to(torch.float32)
        own, other = arms(proprioception, arm)
        tool = self.local(own[:, 7:10], sign)
        away = self.local(other[:, 7:10], sign)
        there = present(objects)
        points = self.local(objects[:, :OBJECTS, :3], sign[:, None])
        points = torch.where(there[:, :OBJECTS, None], points, AWAY_M)
        gripped = gripped_by(points, tool, own[:, 6])
        taken = torch.maximum(gripped, gripped_by(points, away, other[:, 6]))
        near = torch.softmax(-((points - tool[:, None]).norm(dim=-1) / 0.015).clamp(max=60), 1)
        scene = Scene(self, arm, sign, own, tool, away, points, objects, there, gripped, taken)
        tokens = torch.cat([scene.objects(), scene.spots()], 1)
        return View(tokens, self._valid(there), scene.body(arm, other), near, own[:, :6])

    def held(self, proprioception: Tensor, objects: Tensor) -> Tensor:
        """Which objects are in a hand, [B, O] bool, of robots [B, 22] and [B, 18, 9]."""
        points = objects[:, :OBJECTS, :3]
        points = torch.where(present(objects)[:, :OBJECTS, None], points, AWAY_M)
        grips = []
        for arm in range(2):
            own = arms(proprioception, torch.full((len(objects),), arm))[0]
            grips.append(gripped_by(points, own[:, 7:10], own[:, 6]))
        return torch.stack(grips).amax(0) > 0

    def _valid(self, there: Tensor) -> Tensor:
        """Which tokens stand for something that is there, [R, K]."""
        plate, bin_, tub = (there[:, row : row + 1] for row in (PLATE, BIN, TUB))
        parts = (
            there[:, :OBJECTS],
            plate,
            bin_.expand(-1, QUARTERS),
            tub.expand(-1, QUARTERS),
            (~tub).expand(-1, len(self.spots)),
            tub.expand(-1, len(self.tub_spots)),
            torch.ones_like(plate),
        )
        return torch.cat(parts, 1)

    def local(self, points: Tensor, sign: Tensor) -> Tensor:
        """World points [..., 3] as seen from the arm's base: half a turn for the right arm."""
        x, y, z = points.unbind(-1)
        return torch.stack([sign * x + self.base_x, sign * y, z], -1)

    def places(self, objects: Tensor, arm: Tensor, sign: Tensor) -> Tensor:
        """Where things are put, and home: [R, K - O, 3] x, y, height of the floor; world frame."""
        count = len(objects)
        side = -sign  # +1 for the right arm, whose own side is x > 0.
        plate = torch.cat([objects[:, PLATE, :2], self.plate_top.expand(count, 1)], 1)
        containers = [self._quarters(objects[:, row, :2], side) for row in (BIN, TUB)]
        spots = torch.cat([self.spots, self.tub_spots])
        x = side[:, None] * spots[:, 0]
        free = torch.stack([x, spots[:, 1].expand_as(x), torch.zeros_like(x)], -1)
        return torch.cat([plate[:, None], *containers, free, self.home[arm][:, None]], 1)

    def _quarters(self, middle: Tensor, side: Tensor) -> Tensor:
        """The quarters of bin or tub, [R, 4, 3]: the arm's own side first, the far row first."""
        x = torch.stack([side, side, -side, -side], 1) * self.slot
        y = torch.tensor([1.0, -1.0, 1.0, -1.0]) * self.slot
        flat = torch.stack([middle[:, :1] + x, middle[:, 1:] + y.expand_as(x)], -1)
        return torch.cat([flat, self.floor.expand(*x.shape, 1)], -1)


def present(objects: Tensor) -> Tensor:
    """Which bodies are there, [R, 18] bool: the rows of absent ones are zero."""
    return objects.abs().amax(-1) > 0
