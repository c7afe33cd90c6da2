"""One moment as one arm sees it, put together: tokens of things and places, and the arm itself.

R rows (a moment and an arm), O = 15 objects, K' places. Lengths in m, angles in rad.
"""

from math import pi
from typing import NamedTuple, Protocol

import torch
from torch import Tensor
from torch.nn import functional as F

OBJECTS = 15
TOKEN_FEATURES, ABOUT = 46, 11
BODY_FEATURES = 48

OPEN_GAP_M = 0.064
"""A gap below this, with something between the pads, is a grip."""
GRIP_REACH_M = 0.024
HEAP_M = 0.05
FINGER_M = 0.044
RELEASE_M = 0.004
SCALES = (12.0, 48.0, 160.0)
"""Sharpness of the tanh features per metre: without those of a few mm no grasp is learned."""
_TO_ITSELF = torch.eye(OBJECTS) * 10


class Scaling(NamedTuple):
    """How raw numbers become features: (x - offset) * scale, and then perhaps tanh. [F] each."""

    offset: Tensor
    scale: Tensor
    squashed: Tensor

    def __call__(self, raw: Tensor) -> Tensor:
        """Raw numbers [..., F], which it overwrites, as features; all at once, since each call
        costs much the same."""
        features = raw.sub_(self.offset).mul_(self.scale)
        return torch.where(self.squashed, features.tanh(), features)


def _scaling(*rows: tuple[int, float, float, bool]) -> Scaling:
    """From rows of (how many columns, offset, scale, whether tanh)."""
    counts = torch.tensor([count for count, *_ in rows])
    parts = zip(*(row[1:] for row in rows), strict=True)
    return Scaling(*(torch.repeat_interleave(torch.tensor(part), counts) for part in parts))


_TOKEN = _scaling(
    (3, 0.0, 5.0, False),  # The way there: around the axis, outwards, up.
    *((3, 0.0, scale, True) for scale in SCALES),
    (1, 0.0, 5.0, False),  # How far it is in the plane.
    *((1, 0.0, scale, True) for scale in SCALES),
    (3, 0.0, 1.0, False),  # The way's direction.
    (2, 0.0, 1.0, False),  # How far the wrist has to turn.
    (2, 0.0, 5.0, True),
    (2, 0.0, 20.0, True),
    (3, 0.0, 3.0, False),  # Where it is; in polar coordinates; how high.
    (1, 0.0, 1.0, False),
    (1, 0.0, 3.0, False),
    (1, 0.02, 48.0, True),
    (3, 0.0, 8.0, True),  # The way from the other tool, and how long it is.
    (1, 0.0, 3.0, False),
    (ABOUT, 0.0, 1.0, False),
)
_THING = _scaling(
    (3, 0.0, 1.0, False),  # Its tilt; whether this hand holds it; whether any does.
    (2, 0.046, 40.0, True),  # Room for the fingers.
    (1, 0.0, 12.0, True),  # What covers it.
    (1, 0.0, 50.0, False),  # How far it reaches up.
    (4, 0.0, 1.0, False),  # How wide and long it is; whether it is a disc, a block.
)
_PLACE = _scaling(
    (1, 0.0, 10.0, False),  # How high the heap is there.
    (1, 0.0, 12.0, True),  # How near the nearest thing is.
    (1, 0.085, 40.0, True),
    (ABOUT - 3, 0.0, 1.0, False),
)
_BODY = _scaling(
    (6, 0.0, 1.0, False),  # Joints, and the wrist's turn again.
    (1, 0.0, 5.0, True),
    (1, 0.0, 20.0, True),
    (1, 0.0, 10.0, False),  # The gap; whether it is open, or holds what is wide or narrow.
    (1, 0.074, 100.0, True),
    (1, 0.055, 200.0, True),
    (1, 0.02, 60.0, True),
    (3, 0.0, 3.0, False),  # The tool; in polar coordinates; how high.
    (1, 0.0, 3.0, False),
    (1, 0.0, 1.0, False),
    *((1, 0.16, scale, True) for scale in SCALES),
    *((1, 0.0, scale, True) for scale in SCALES[:2]),
    (1, 0.0, 1.0, False),  # What it holds: whether, how thick, how far from the tool, how turned.
    (1, 0.0, 50.0, False),
    (3, 0.0, 48.0, True),
    (1, 0.0, 1.0, False),
    (7, 0.0, 1.0, False),  # Which arm it is; the other one's joints and gap.
    (1, 0.0, 10.0, False),
    (3, 0.0, 3.0, False),  # The other tool; whether it holds something; the way to it.
    (1, 0.0, 1.0, False),
    (1, 0.0, 3.0, False),
    (3, 0.0, 12.0, True),
    (4, 0.0, 1.0, False),  # The most tilted thing; how many it holds; how long and round.
)


class Cell(Protocol):
    """What a scene needs of the cell's measures, see `Geometry`."""

    sizes: Tensor
    round: Tensor
    block: Tensor


class Scene:
    """The parts of one view while it is put together; places and points as the arm sees them.

    hands: [R, 2, 3] this tool and the other. grips: [R, 2, O] what they hold.
    """

    def __init__(
        self,
        cell: Cell,
        sign: Tensor,
        own: Tensor,
        hands: Tensor,
        points: Tensor,
        places: Tensor,
        objects: Tensor,
        there: Tensor,
        grips: Tensor,
    ) -> None:
        self.cell, self.sign, self.own = cell, sign, own
        self.points, self.places = points, places
        self.tool, self.away = hands.unbind(1)
        self.gripped, self.taken = grips[:, 0], grips.amax(1)
        self.held = self.gripped.amax(1, keepdim=True)
        carried = (self.gripped.unsqueeze(-1) * points).sum(1)
        self.origin = self.held * carried + (1 - self.held) * self.tool
        self.lying = (1 - self.taken).unsqueeze(1)
        self._turned(objects[:, :OBJECTS], there[:, :OBJECTS])
        self.half = (self.gripped * self.halves).sum(1, keepdim=True)
        self.misturn = self._misturn()
        wide_long = (cell.sizes[:, :2] - 0.025) * 50
        self.measures = torch.cat([wide_long, torch.stack([cell.round, cell.block], 1)], 1)

    def _turned(self, poses: Tensor, there: Tensor) -> None:
        """How each object is turned: yaw to grip it, tilt, and how far it reaches up and down."""
        wide, long = poses[..., 3:6], poses[..., 6:9]
        high = torch.cross(wide, long, dim=-1)
        block = self.cell.block.bool()
        self.tilt = torch.where(there & ~block, high[..., 2], 1.0)
        on_side = block & (wide[..., 2].abs() > high[..., 2].abs())
        axis = torch.where(on_side.unsqueeze(-1), high, wide)
        sides = torch.atan2(axis[..., 1], axis[..., 0])
        sides = torch.where(block, wrap(sides, pi), wrap(sides, pi / 2))
        self.yaws = sides * (1 - self.cell.round)
        upward = torch.stack([wide[..., 2], long[..., 2], high[..., 2]], -1).abs()
        sizes = self.cell.sizes
        self.halves = torch.where(block, (upward * sizes).sum(-1), sizes[:, 2])

    def tokens(self) -> Tensor:
        """Objects and home seen from the tool, places from what is in the hand."""
        top, gap = self._heap()
        points = torch.cat([self.points, self.places], 1)
        rest = top + self.half + self.held * RELEASE_M
        points[:, OBJECTS:-1, 2] = rest[:, :-1]
        yaw = (self.own[:, 10:11] - self.misturn).expand_as(top)
        about = torch.cat([self._things(), self._places(top, gap)], 1)
        return self._token(points, torch.cat([self.yaws, yaw], 1), about)

    def _from(self) -> Tensor:
        """Where each token is seen from: x y z, distance and direction from the axis, [R, K, 5]."""
        ends = torch.stack([self.tool, self.origin], 1)
        ends = torch.cat([ends, torch.stack(_polar(ends), -1)], -1)
        tool, origin = ends[:, :1], ends[:, 1:]
        puts = self.places.shape[1] - 1  # The last place is home, seen like a thing.
        return torch.cat([tool.expand(-1, OBJECTS, -1), origin.expand(-1, puts, -1), tool], 1)

    def _things(self) -> Tensor:
        """What an object is like and how it lies, [R, O, ABOUT]."""
        lies = [self.tilt, self.gripped, self.taken, *self._room(), self._cover(), self.halves]
        measures = self.measures.expand(len(self.tilt), -1, -1)
        return _THING(torch.cat([torch.stack(lies, -1), measures], -1))

    def _places(self, top: Tensor, gap: Tensor) -> Tensor:
        """What lies at and around a place, [R, K', ABOUT]."""
        return _PLACE(F.pad(torch.stack([top, gap, gap], -1), (0, ABOUT - 3)))

    def _token(self, points: Tensor, yaws: Tensor, about: Tensor) -> Tensor:
        """Points [R, K, 3] as seen from `_from`."""
        reach, heading = _polar(points)
        start = self._from()
        way, aside = points - start[..., :3], points - self.away.unsqueeze(1)
        arc = wrap(heading - start[..., 4], 2 * pi) * start[..., 3]
        step = torch.stack([arc, reach - start[..., 3], way[..., 2]], -1)
        flat = way[..., :2].norm(dim=-1, keepdim=True)
        direction = step / (way.norm(dim=-1, keepdim=True) + 0.004)
        turns = self._turns(heading, yaws)
        polar = torch.stack([heading, reach, points[..., 2]], -1)
        far = aside.norm(dim=-1, keepdim=True)
        scaled = *[step] * 4, *[flat] * 4, direction, *[turns] * 3
        return _TOKEN(torch.cat([*scaled, points, polar, aside, far, about], -1))

    def _turns(self, heading: Tensor, yaws: Tensor) -> Tensor:
        """How far the wrist has to turn for `yaws` and for a quarter more, [R, K, 2]."""
        first = heading + pi / 2 - yaws
        return wrap(torch.stack([first, first - pi / 2], -1) - self.own[:, 5, None, None], pi)

    def _misturn(self) -> Tensor:
        """How far what is held is turned from the table's axes, [R, 1]."""
        free = wrap(self.own[:, 10:11], pi / 2)
        turn = torch.where(self.cell.round > 0, free, wrap(self.yaws, pi / 2))
        return (self.gripped * turn).sum(1, keepdim=True)

    def _room(self) -> tuple[Tensor, ...]:
        """How far each object's nearest neighbour is from where the fingers go, twice [R, O]."""
        # The yaws are the world's; the arm's frame may be half a turn off, which is the same.
        yaws = torch.stack([self.yaws, self.yaws + pi / 2])
        along = torch.stack([torch.cos(yaws), torch.sin(yaws)], -1) * FINGER_M
        flat = self.points[..., :2]
        gaps = torch.cdist(torch.stack([flat + along, flat - along]), flat) + _TO_ITSELF
        return gaps.amin((0, -1)).unbind()

    def _cover(self) -> Tensor:
        """How much higher than each object the heap above it is, [R, O]."""
        flat, height = self.points[..., :2], self.points[..., 2]
        above = torch.cdist(flat, flat) < 0.045
        heights = height.unsqueeze(1) * above * self.lying
        return (heights.amax(-1) - height).clamp(min=0)

    def _heap(self) -> tuple[Tensor, Tensor]:
        """Height of the heap at each place, and distance of the nearest thing, [R, K']."""
        gaps = torch.cdist(self.places[..., :2], self.points[..., :2])
        tops = (self.points[..., 2] + self.halves).unsqueeze(1)
        heap = (tops * (gaps < HEAP_M) * self.lying).amax(-1)
        return torch.maximum(heap, self.places[..., 2]), (gaps + (1 - self.lying)).amin(-1)

    def body(self, other: Tensor) -> Tensor:
        """The arm itself: joints, tool, gripper, and what the other arm does, [R, BODY]."""
        polar = torch.stack(_polar(self.tool), 1)
        turn, gap, height = self.own[:, 5:6], self.own[:, 6:7], self.tool[:, 2:3]
        way = self.away - self.tool
        is_like = (self.gripped.unsqueeze(-1) * self.measures[:, 1:3]).sum(1)
        raw = [
            *(self.own[:, :6], turn, turn, *[gap] * 4),
            *(self.tool, polar, *[height] * 5),
            *(self.held, self.half, self.origin - self.tool, self.misturn),
            *(self.sign.unsqueeze(1), other[:, :7]),
            *(self.away, (self.taken - self.gripped).amax(1, keepdim=True)),
            *(way.norm(dim=1, keepdim=True), way),
            *(self.tilt.amin(1, keepdim=True), self.gripped.sum(1, keepdim=True), is_like),
        ]
        return _BODY(torch.cat(raw, -1))


def wrap(angle: Tensor, period: float) -> Tensor:
    """`angle` brought into [-period/2, period/2)."""
    return torch.remainder(angle + period / 2, period) - period / 2


def arms(proprioception: Tensor) -> Tensor:
    """Seven joints and the tool pose of each arm, [R, 2, 11]."""
    joints = proprioception[:, :14].reshape(-1, 2, 7)
    return torch.cat([joints, proprioception[:, 14:22].reshape(-1, 2, 4)], -1)


def distances(points: Tensor, hands: Tensor) -> Tensor:
    """How far points [R, O, 3] are from two hands [R, 2, 3], [R, 2, O]."""
    far: Tensor = (points.unsqueeze(1) - hands.unsqueeze(2)).norm(dim=-1)
    return far


def gripped_by(far: Tensor, gaps: Tensor) -> Tensor:
    """1 for what is between the pads of a closed gripper, else 0, [R, 2, O].

    far: see `distances`. gaps: [R, 2] of the grippers.
    """
    nearest = far <= far.amin(-1, keepdim=True)
    grip = nearest & (far < GRIP_REACH_M) & (gaps < OPEN_GAP_M).unsqueeze(-1)
    return grip.to(torch.float32)


def _polar(points: Tensor) -> tuple[Tensor, Tensor]:
    """Distance from the arm's axis and direction from it."""
    reach: Tensor = points[..., :2].norm(dim=-1)
    return reach, torch.atan2(points[..., 1], points[..., 0])
