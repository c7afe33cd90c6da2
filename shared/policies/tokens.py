"""One moment as one arm sees it, put together: tokens of things and places, and the arm itself.

R rows (a moment and an arm), O = 15 objects, K' places. Lengths in m, angles in rad.
"""

from math import pi
from typing import Protocol

import torch
from torch import Tensor

OBJECTS = 15
TOKEN_FEATURES = 46
BODY_FEATURES = 48

OPEN_GAP_M = 0.064
"""A gap below this, with something between the pads, is a grip."""
GRIP_REACH_M = 0.024
HEAP_M = 0.05
FINGER_M = 0.044
RELEASE_M = 0.004
SCALES = (12.0, 48.0, 160.0)
"""Sharpness of the tanh features per metre: without those of a few mm no grasp is learned."""


class Cell(Protocol):
    """What a scene needs of the cell's measures, see `Geometry`."""

    sizes: Tensor
    round: Tensor
    block: Tensor

    def local(self, points: Tensor, sign: Tensor) -> Tensor: ...

    def places(self, objects: Tensor, arm: Tensor, sign: Tensor) -> Tensor: ...


class Scene:
    """The parts of one view while it is put together."""

    def __init__(
        self,
        cell: Cell,
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


def arms(proprioception: Tensor, arm: Tensor) -> tuple[Tensor, Tensor]:
    """Seven joints and the tool pose of this arm and of the other, [R, 11] each."""
    joints = proprioception[:, :14].reshape(-1, 2, 7)
    tools = proprioception[:, 14:22].reshape(-1, 2, 4)
    both = torch.cat([joints, tools], -1)
    rows = torch.arange(len(arm))
    return both[rows, arm], both[rows, 1 - arm]


def gripped_by(points: Tensor, tool: Tensor, gap: Tensor) -> Tensor:
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
