"""What the low level can see at a glance: the scene as each arm sees it, in tokens.

Each arm looks at the world from its own base, so that one network serves both. R rows (a
moment and an arm), O = 15 objects, K = 48 tokens: the objects, the plate, the quarters of bin and
tub, the free spots of both tables, home. A thing is described by its measures, not by its name.
Lengths in m, angles in rad. A pure function of proprioception and object poses.
"""

from typing import NamedTuple

import torch
from torch import Tensor, nn
from torch.nn import functional as F

from shared.policies.tokens import OBJECTS, Scene, arms, distances, gripped_by

PLATE, BIN, TUB, NO_TUB, ALWAYS = range(OBJECTS, OBJECTS + 5)
QUARTERS = 4
CORNERS = torch.tensor([[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]])
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

    @property
    def whose(self) -> Tensor:
        """[K] int64: what must be there for each token, a row of what `_valid` asks."""
        rows = torch.tensor([*range(OBJECTS + 1), BIN, TUB, NO_TUB, TUB, ALWAYS])
        spots = (QUARTERS, QUARTERS, len(self.spots), len(self.tub_spots), 1)
        return torch.repeat_interleave(rows, torch.tensor([*[1] * (OBJECTS + 1), *spots]))

    def forward(self, proprioception: Tensor, objects: Tensor, arm: Tensor) -> View:
        """proprioception [R, 22], objects [R, 18, 9], arm [R] int64: 0 left, 1 right."""
        sign = 1.0 - 2.0 * arm.to(torch.float32)
        rows = torch.arange(len(arm)).unsqueeze(1)
        both = arms(proprioception)[rows, torch.stack([arm, 1 - arm], 1)]
        own, other = both.unbind(1)
        there = present(objects)
        # All at once: so few numbers cost little, and each call the same.
        world = [both[..., 7:10], objects[:, :OBJECTS, :3], self.places(objects, arm, sign)]
        seen = self.local(torch.cat(world, 1), sign)
        hands, points, places = seen.tensor_split((2, 2 + OBJECTS), 1)
        points = torch.where(there[:, :OBJECTS, None], points, AWAY_M)
        far = distances(points, hands)
        grips = gripped_by(far, both[..., 6])
        near = torch.softmax(-(far[:, 0] / 0.015).clamp(max=60), 1)
        scene = Scene(self, sign, own, hands, points, places, objects, there, grips)
        return View(scene.tokens(), self._valid(there), scene.body(other), near, own[:, :6])

    def held(self, proprioception: Tensor, objects: Tensor) -> Tensor:
        """Which objects are in a hand, [B, O] bool, of robots [B, 22] and [B, 18, 9]."""
        return self.grips(proprioception, objects).amax(1) > 0

    def grips(self, proprioception: Tensor, objects: Tensor) -> Tensor:
        """1 for what is in each hand, left first, else 0, [B, 2, O]; of the same."""
        points = objects[:, :OBJECTS, :3]
        points = torch.where(present(objects)[:, :OBJECTS, None], points, AWAY_M)
        both = arms(proprioception)
        return gripped_by(distances(points, both[..., 7:10]), both[..., 6])

    def _valid(self, there: Tensor) -> Tensor:
        """Which tokens stand for something that is there, [R, K]."""
        tub = there[:, TUB:]
        return torch.cat([there, ~tub, torch.ones_like(tub)], 1)[:, self.whose]

    def local(self, points: Tensor, sign: Tensor) -> Tensor:
        """World points [R, N, 3] as seen from the arm's base: half a turn for the right arm."""
        turn = torch.stack([sign, sign, torch.ones_like(sign)], 1)
        return points * turn.unsqueeze(1) + F.pad(self.base_x.reshape(1), (0, 2))

    def places(self, objects: Tensor, arm: Tensor, sign: Tensor) -> Tensor:
        """Where things are put, and home: [R, K - O, 3] x, y, height of the floor; world frame.

        Of quarters and spots the arm's own side comes first, and the far row of quarters.
        """
        # +1 for the right arm, whose own side is x > 0.
        side = torch.stack([-sign, torch.ones_like(sign)], 1).unsqueeze(1)
        spots = torch.cat([self.spots, self.tub_spots])
        corners = objects[:, BIN:, None, :2] + (CORNERS * self.slot * side).unsqueeze(1)
        plate = objects[:, PLATE, None, :2]
        flat = torch.cat([plate, corners.flatten(1, 2), spots * side], 1)
        floors = (self.plate_top.reshape(1), self.floor.expand(2 * QUARTERS))
        heights = F.pad(torch.cat(floors), (0, len(spots))).expand(len(objects), -1)
        return torch.cat([torch.cat([flat, heights.unsqueeze(-1)], -1), self.home[arm][:, None]], 1)


def present(objects: Tensor) -> Tensor:
    """Which bodies are there, [R, 18] bool: the rows of absent ones are zero."""
    return objects.abs().amax(-1) > 0
