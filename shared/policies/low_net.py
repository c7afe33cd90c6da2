"""The low level's network: one arm, one moment and a command in; that arm's next motions out.

R rows (a moment and an arm), K tokens, S = 10 steps of a chunk, 7 joints an arm.
"""

from typing import NamedTuple

import torch
from torch import Tensor, nn

from shared.policies.geometry import (
    HOME,
    IN_BIN,
    IN_TUB,
    ON_PLATE,
    SPOT,
    THING,
    Geometry,
    View,
)
from shared.policies.tokens import BODY_FEATURES, OBJECTS, TOKEN_FEATURES

CHUNK = 10
JOINTS = 6
UNIT_RAD = 0.01
"""Below this a change of a joint is learned in proportion, above it by its logarithm."""
OPEN_M, CLOSED_M = 0.080, -0.020
HEADS = 4
KINDS = 6

VERBS = ("pick", "plate", "bin", "tub", "down", "wait")
_ABOUT = {
    "pick": (THING, SPOT),  # What is in the way, in the hand, is put down first.
    "plate": (ON_PLATE,),
    "bin": (IN_BIN,),
    "tub": (IN_TUB,),
    "down": (SPOT,),
    "wait": (),
}


class Orders(NamedTuple):
    """Commands as the network reads them: verbs [R] int64, rows of `VERBS`; things [R] int64, the
    row of the object, -1 for none."""

    verbs: Tensor
    things: Tensor


class Motion(NamedTuple):
    """changes [R, S, 7]: squashed joint changes and a logit of the gripper being open;
    done [R]: a logit of the command being achieved."""

    changes: Tensor
    done: Tensor


class LowNet(nn.Module):
    """Looks at the tokens that the command is about, then maps them to joint motions.

    The command points at its object; among places of its kind the network chooses by how they
    lie (`HEADS` soft choices). What is at the tool and the maximum over all tokens are added. The
    output is the change of each joint from now, squashed by asinh so that a millimetre near the
    goal weighs as much as a decimetre far from it, and a logit for the gripper being open.
    """

    kinds: Tensor
    about: Tensor

    def __init__(self, geometry: Geometry, width: int = 384) -> None:
        super().__init__()
        self.geometry = geometry
        self.register_buffer("kinds", geometry.kinds, persistent=False)
        about = torch.zeros(len(VERBS), KINDS, dtype=torch.bool)
        for row, verb in enumerate(VERBS):
            about[row, [*_ABOUT[verb], HOME]] = True
        self.register_buffer("about", about, persistent=False)
        self.command = nn.Embedding(len(VERBS), 64)
        self.kind = nn.Parameter(torch.randn(KINDS, 32) * 0.3)
        self.lie = nn.Linear(TOKEN_FEATURES, 32)
        self.choose = nn.Linear(64, HEADS * 32)
        self.weigh = nn.Linear(64, HEADS * 32)
        self.label = nn.Parameter(torch.randn(KINDS, 8) * 0.3)
        self.sight = nn.Sequential(nn.Linear(TOKEN_FEATURES + 8, 64), nn.GELU())
        chosen = (HEADS + 2) * (TOKEN_FEATURES + 8) + 64
        self.enter = nn.Linear(chosen + BODY_FEATURES + 64, width)
        self.blocks = nn.ModuleList(
            nn.Sequential(nn.LayerNorm(width), nn.Linear(width, width), nn.GELU()) for _ in range(2)
        )
        self.leave = nn.Sequential(
            nn.LayerNorm(width), nn.Linear(width, width), nn.GELU(), nn.Linear(width, CHUNK * 7)
        )
        self.finished = nn.Sequential(
            nn.LayerNorm(width), nn.Linear(width, 64), nn.GELU(), nn.Linear(64, 1)
        )

    def forward(self, view: View, orders: Orders, extra: Tensor | None = None) -> Motion:
        """What this arm does for its command. extra: [R, 64], what more is known of it."""
        command = self.command(orders.verbs)
        if extra is not None:
            command = command + extra
        tokens = self.labelled(view)
        chosen = self._choice(view, orders, command) @ tokens
        pointed = tokens[torch.arange(len(command)), orders.things.clamp(min=0)]
        pointed = pointed * (orders.things >= 0).unsqueeze(1)
        return self.move(view, tokens, chosen, pointed, command)

    def labelled(self, view: View) -> Tensor:
        """The tokens with a label of their kind, [R, K, TOKEN_FEATURES + 8]."""
        labels = self.label[self.kinds].expand(len(view.tokens), -1, -1)
        return torch.cat([view.tokens, labels], -1)

    def move(
        self, view: View, tokens: Tensor, chosen: Tensor, pointed: Tensor, command: Tensor
    ) -> Motion:
        """From what was chosen [R, HEADS, *] and pointed at [R, *], and the command [R, 64]."""
        near = (view.near.unsqueeze(1) @ tokens[:, :OBJECTS]).flatten(1)
        sights = self.sight(tokens).masked_fill(~view.valid.unsqueeze(-1), -1.0).amax(1)
        parts = [chosen.flatten(1), near, pointed, sights, view.body, command]
        x = self.enter(torch.cat(parts, -1))
        for block in self.blocks:
            x = x + block(x)
        return Motion(self.leave(x).unflatten(-1, (CHUNK, 7)), self.finished(x).squeeze(-1))

    def appeal(self, view: View, command: Tensor) -> Tensor:
        """How much each head likes each token, [R, HEADS, K]."""
        kinds = self.kind[self.kinds]
        by_kind = self.choose(command).unflatten(-1, (HEADS, 32)) @ kinds.T
        lies = nn.functional.gelu(self.lie(view.tokens))
        by_lie = self.weigh(command).unflatten(-1, (HEADS, 32)) @ lies.transpose(1, 2)
        scores: Tensor = (by_kind + by_lie).float()
        return scores

    def _choice(self, view: View, orders: Orders, command: Tensor) -> Tensor:
        """Weights of the tokens for each head, [R, HEADS, K]."""
        allowed = self.about[orders.verbs][:, self.kinds] & view.valid
        rows = torch.arange(OBJECTS)
        allowed[:, :OBJECTS] &= rows == orders.things.unsqueeze(1)
        scores = self.appeal(view, command).masked_fill(~allowed.unsqueeze(1), -1e4)
        return torch.softmax(scores, -1).to(command.dtype)


def squash(change: Tensor) -> Tensor:
    """Changes in rad as the network gives them."""
    return torch.asinh(change / UNIT_RAD)


def targets(changes: Tensor, now: Tensor) -> Tensor:
    """Joint targets [R, S, 7] (rad, gripper in m) from the network's output and [R, 6]."""
    joints = now.unsqueeze(1) + torch.sinh(changes[..., :JOINTS].clamp(-5, 5)) * UNIT_RAD
    grip = torch.where(changes[..., JOINTS:] > 0, OPEN_M, CLOSED_M)
    return torch.cat([joints, grip], -1)
