"""What the low level can see at a glance: the scene as each arm sees it, in tokens.

Each arm looks at the world from its own base, so that one network serves both. R rows (a
moment and an arm), O = 15 objects, K = 48 tokens: the objects, the plate, the quarters of bin and
tub, the free spots of both tables, home. A thing is described by its measures, not by its name.
Lengths in m, angles in rad. A pure function of proprioception and object poses.
"""

from math import pi
from typing import NamedTuple

import torch
from torch import Tensor, nn

OBJECTS = 15
PLATE, BIN, TUB = 15, 16, 17
QUARTERS = 4
THING, ON_PLATE, IN_BIN, IN_TUB, SPOT, HOME = range(6)
"""Kinds of tokens."""
TOKEN_FEATURES = 46
BODY_FEATURES = 48

OPEN_GAP_M = 0.064
"""A gap below this, with something between the pads, is a grip."""
GRIP_REACH_M = 0.024
HEAP_M = 0.05
FINGER_M = 0.044
RELEASE_M = 0.004
AWAY_M = 5.0
"""Where an absent thing is put, from any arm: no rule takes it for near."""
SCALES = (12.0, 48.0, 160.0)
"""Sharpness of the tanh features per metre: without those of a few mm no grasp is learned."""
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
        own, other = _arms(proprioception, arm)
        tool = self.local(own[:, 7:10], sign)
        away = self.local(other[:, 7:10], sign)
        there = present(objects)
        points = self.local(objects[:, :OBJECTS, :3], sign[:, None])
        points = torch.where(there[:, :OBJECTS, None], points, AWAY_M)
        gripped = _gripped(points, tool, own[:, 6])
        taken = torch.maximum(gripped, _gripped(points, away, other[:, 6]))
        near = torch.softmax(-((points - tool[:, None]).norm(dim=-1) / 0.015).clamp(max=60), 1)
        scene = _Scene(self, arm, sign, own, tool, away, points, objects, there, gripped, taken)
        tokens = torch.cat([scene.objects(), scene.spots()], 1)
        return View(tokens, self._valid(there), scene.body(arm, other), near, own[:, :6])

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


class _Scene:
    """The parts of one view while it is put together."""

    def __init__(
        self,
        cell: Geometry,
        arm: Tensor,
        sign: Tensor,
        own: Tensor,
        tool: Tensor,
        away: Tensor,
        points: Tensor,
        objects: Tensor,
        there: Tensor,
        gripped: Tensor,
        taken: Tensor,
    ) -> None:
        self.cell, self.arm, self.sign, self.own = cell, arm, sign, own
        self.tool, self.away, self.points = tool, away, points
        self.gripped, self.taken, self.poses = gripped, taken, objects
        held = gripped.amax(1, keepdim=True)
        carried = (gripped.unsqueeze(-1) * points).sum(1)
        self.origin = held * carried + (1 - held) * tool
        self.held = held
        self._turned(objects[:, :OBJECTS], there[:, :OBJECTS])
        self.half = (gripped * self.halves).sum(1)

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

    def objects(self) -> Tensor:
        """Tokens of the objects, seen from the tool."""
        turns = self._turns(self.points, self.yaws)
        extra = torch.stack(
            [
                self.tilt,
                self.gripped,
                self.taken,
                *self._room().unbind(-1),
                torch.tanh(12 * self._cover()),
                self.halves * 50,
                *(measure.expand_as(self.tilt) for measure in self._measures()),
            ],
            -1,
        )
        return self._token(self.points, self.tool, turns, extra)

    def _measures(self) -> tuple[Tensor, ...]:
        """What an object is like, [O] each."""
        wide, long, _ = self.cell.sizes.unbind(-1)
        return (wide - 0.025) * 50, (long - 0.025) * 50, self.cell.round, self.cell.block

    def spots(self) -> Tensor:
        """Tokens of the places, seen from what is in the hand; the last one is home."""
        places = self.cell.places(self.poses, self.arm, self.sign)
        places = self.cell.local(places, self.sign[:, None])
        top, gap = self._heap(places)
        rest = top + self.half[:, None] + self.held * RELEASE_M
        spots = torch.cat([places[..., :2], rest.unsqueeze(-1)], -1)
        yaw = (self.own[:, 10] - self._misturn())[:, None].expand(top.shape)
        turns = self._turns(spots, yaw)
        none = torch.zeros_like(top)
        about = [top * 10, torch.tanh(12 * gap), torch.tanh(40 * (gap - 0.085)), *[none] * 8]
        extra = torch.stack(about, -1)
        tokens = self._token(spots[:, :-1], self.origin, turns[:, :-1], extra[:, :-1])
        home = self._token(places[:, -1:], self.tool, turns[:, -1:], extra[:, -1:])
        return torch.cat([tokens, home], 1)

    def _token(self, points: Tensor, origin: Tensor, turns: Tensor, extra: Tensor) -> Tensor:
        origin = origin.unsqueeze(1)
        reach, heading = _polar(points)
        from_reach, from_heading = _polar(origin)
        arc = wrap(heading - from_heading, 2 * pi) * from_reach
        step = torch.stack([arc, reach - from_reach, points[..., 2] - origin[..., 2]], -1)
        flat = (points - origin)[..., :2].norm(dim=-1, keepdim=True)
        whole = (points - origin).norm(dim=-1, keepdim=True)
        return torch.cat(
            [
                step * 5,
                *(torch.tanh(scale * step) for scale in SCALES),
                flat * 5,
                *(torch.tanh(scale * flat) for scale in SCALES),
                step / (whole + 0.004),
                turns,
                torch.tanh(5 * turns),
                torch.tanh(20 * turns),
                points * 3,
                heading.unsqueeze(-1),
                reach.unsqueeze(-1) * 3,
                torch.tanh(48 * (points[..., 2:] - 0.02)),
                torch.tanh(8 * (points - self.away.unsqueeze(1))),
                (self.away.unsqueeze(1) - points).norm(dim=-1, keepdim=True) * 3,
                extra,
            ],
            -1,
        )

    def _turns(self, points: Tensor, yaws: Tensor) -> Tensor:
        """How far the wrist has to turn for `yaws` and for a quarter more, [R, K, 2]."""
        _, heading = _polar(points)
        now = self.own[:, 5].unsqueeze(1)
        first = heading + pi / 2 - yaws
        return torch.stack([wrap(first - now, pi), wrap(first - pi / 2 - now, pi)], -1)

    def _misturn(self) -> Tensor:
        """How far what is held is turned from the table's axes, [R]."""
        free = wrap(self.own[:, 10], pi / 2).unsqueeze(1)
        turn = torch.where(self.cell.round > 0, free, wrap(self.yaws, pi / 2))
        return (self.gripped * turn).sum(1)

    def _room(self) -> Tensor:
        """Distance of each object's nearest neighbour from where the fingers go, [R, O, 2]."""
        rooms = []
        for quarter in (0.0, pi / 2):
            # The yaws are the world's; the arm's frame may be half a turn off, which is the same.
            yaw = self.yaws + quarter
            along = torch.stack([torch.cos(yaw), torch.sin(yaw)], -1) * FINGER_M
            flat = self.points[..., :2]
            gaps = torch.stack([_gaps(flat + along, flat), _gaps(flat - along, flat)])
            rooms.append(torch.tanh(40 * (gaps.amin(0) - 0.046)))
        return torch.stack(rooms, -1)

    def _cover(self) -> Tensor:
        """How much higher than each object the heap above it is, [R, O]."""
        flat = self.points[..., :2]
        above = torch.cdist(flat, flat) < 0.045
        heights = self.points[:, None, :, 2] * above * (1 - self.taken[:, None, :])
        return (heights.amax(-1) - self.points[..., 2]).clamp(min=0)

    def _heap(self, spots: Tensor) -> tuple[Tensor, Tensor]:
        """Height of the heap at each spot, and distance of the nearest thing, [R, K']."""
        gaps = torch.cdist(spots[..., :2], self.points[..., :2])
        lying = (1 - self.taken).unsqueeze(1)
        tops = (self.points[..., 2] + self.halves).unsqueeze(1)
        heap = (tops * (gaps < HEAP_M) * lying).amax(-1)
        return torch.maximum(heap, spots[..., 2]), (gaps + (1 - lying)).amin(-1)

    def body(self, arm: Tensor, other: Tensor) -> Tensor:
        """The arm itself: joints, tool, gripper, and what the other arm does, [R, BODY]."""
        reach, heading = _polar(self.tool)
        turn, gap = self.own[:, 5:6], self.own[:, 6:7]
        lift = self.tool[:, 2:3] - 0.16
        return torch.cat(
            [
                self.own[:, :6],
                torch.tanh(5 * turn),
                torch.tanh(20 * turn),
                gap * 10,
                torch.tanh(100 * (gap - 0.074)),
                torch.tanh(200 * (gap - 0.055)),
                torch.tanh(60 * (gap - 0.02)),
                self.tool * 3,
                reach.unsqueeze(1) * 3,
                heading.unsqueeze(1),
                *(torch.tanh(scale * lift) for scale in SCALES),
                *(torch.tanh(scale * self.tool[:, 2:3]) for scale in SCALES[:2]),
                self.held,
                self.half.unsqueeze(1) * 50,
                torch.tanh(48 * (self.origin - self.tool)),
                self._misturn().unsqueeze(1),
                (1.0 - 2.0 * arm.to(torch.float32)).unsqueeze(1),
                other[:, :6],
                other[:, 6:7] * 10,
                self.away * 3,
                (self.taken - self.gripped).amax(1, keepdim=True),
                (self.away - self.tool).norm(dim=1, keepdim=True) * 3,
                torch.tanh(12 * (self.away - self.tool)),
                self.tilt.amin(1, keepdim=True),
                self.gripped.sum(1, keepdim=True),
                *(
                    (self.gripped * measure).sum(1, keepdim=True)
                    for measure in self._measures()[1:3]
                ),
            ],
            -1,
        )


def wrap(angle: Tensor, period: float) -> Tensor:
    """`angle` brought into [-period/2, period/2)."""
    return torch.remainder(angle + period / 2, period) - period / 2


def _arms(proprioception: Tensor, arm: Tensor) -> tuple[Tensor, Tensor]:
    """Seven joints and the tool pose of this arm and of the other, [R, 11] each."""
    joints = proprioception[:, :14].reshape(-1, 2, 7)
    tools = proprioception[:, 14:22].reshape(-1, 2, 4)
    both = torch.cat([joints, tools], -1)
    rows = torch.arange(len(arm))
    return both[rows, arm], both[rows, 1 - arm]


def _gripped(points: Tensor, tool: Tensor, gap: Tensor) -> Tensor:
    """1 for the object between the pads of a closed gripper, else 0, [R, O]."""
    far: Tensor = (points - tool.unsqueeze(1)).norm(dim=-1)
    nearest = far <= far.amin(1, keepdim=True)
    grip = nearest & (far < GRIP_REACH_M) & (gap < OPEN_GAP_M).unsqueeze(1)
    return grip.to(torch.float32)


def _polar(points: Tensor) -> tuple[Tensor, Tensor]:
    """Distance from the arm's axis and direction from it."""
    reach: Tensor = points[..., :2].norm(dim=-1)
    return reach, torch.atan2(points[..., 1], points[..., 0])


def _gaps(fingers: Tensor, points: Tensor) -> Tensor:
    """Distance of each finger [R, O, 2] from the nearest other object, [R, O]."""
    gaps = torch.cdist(fingers, points)
    nearest: Tensor = (gaps + torch.eye(OBJECTS) * 10).amin(-1)
    return nearest
