"""The low level's network: one arm, one moment and a command in; that arm's next motions out.

R rows (a moment and an arm), K tokens, S = 10 steps of a chunk, 7 joints an arm.
"""

import torch
from torch import Tensor, nn

from shared.policies.geometry import BODY_FEATURES, OBJECTS, TOKEN_FEATURES, Geometry, View

CHUNK = 10
JOINTS = 6
UNIT_RAD = 0.01
"""Below this a change of a joint is learned in proportion, above it by its logarithm."""
OPEN_M, CLOSED_M = 0.080, -0.020
HEADS = 4


class LowNet(nn.Module):
    """Picks the tokens that the command is about, then maps them to joint motions.

    The command selects tokens by their kind and by how they lie (`HEADS` soft choices); what is
    at the tool and the maximum over all tokens are added. The output is the change of each joint
    from now, squashed by asinh so that a millimetre near the goal weighs as much as a
    decimetre far from it, and a logit for the gripper being open.
    """

    def __init__(self, geometry: Geometry, width: int = 384, words: int = 384) -> None:
        super().__init__()
        self.geometry = geometry
        kinds = OBJECTS + geometry.places.shape[1]
        self.command = nn.Sequential(nn.Linear(words, 64), nn.GELU(), nn.LayerNorm(64))
        self.kind = nn.Parameter(torch.randn(kinds, 32) * 0.3)
        self.lie = nn.Linear(TOKEN_FEATURES, 32)
        self.choose = nn.Linear(64, HEADS * 32)
        self.weigh = nn.Linear(64, HEADS * 32)
        self.label = nn.Parameter(torch.randn(kinds, 8) * 0.3)
        self.sight = nn.Sequential(nn.Linear(TOKEN_FEATURES + 8, 64), nn.GELU())
        chosen = HEADS * (TOKEN_FEATURES + 8) + TOKEN_FEATURES + 8 + 64
        self.enter = nn.Linear(chosen + BODY_FEATURES + 64, width)
        self.blocks = nn.ModuleList(
            nn.Sequential(nn.LayerNorm(width), nn.Linear(width, width), nn.GELU()) for _ in range(2)
        )
        self.leave = nn.Sequential(
            nn.LayerNorm(width), nn.Linear(width, width), nn.GELU(), nn.Linear(width, CHUNK * 7)
        )

    def forward(self, view: View, words: Tensor) -> Tensor:
        """words [R, 384] sentence vectors; returns [R, S, 7], squashed changes and a logit."""
        command = self.command(words)
        tokens = torch.cat([view.tokens, self.label.expand(len(words), -1, -1)], -1)
        chosen = self._choice(view.tokens, command) @ tokens
        near = (view.near.unsqueeze(1) @ tokens[:, :OBJECTS]).flatten(1)
        sights = self.sight(tokens).amax(1)
        x = self.enter(torch.cat([chosen.flatten(1), near, sights, view.body, command], -1))
        for block in self.blocks:
            x = x + block(x)
        changes: Tensor = self.leave(x).unflatten(-1, (CHUNK, 7))
        return changes

    def _choice(self, tokens: Tensor, command: Tensor) -> Tensor:
        """Weights of the tokens for each head, [R, HEADS, K]."""
        by_kind = self.choose(command).unflatten(-1, (HEADS, 32)) @ self.kind.T
        lies = nn.functional.gelu(self.lie(tokens))
        by_lie = self.weigh(command).unflatten(-1, (HEADS, 32)) @ lies.transpose(1, 2)
        return torch.softmax(by_kind + by_lie, -1)


def squash(change: Tensor) -> Tensor:
    """Changes in rad as the network gives them."""
    return torch.asinh(change / UNIT_RAD)


def targets(changes: Tensor, now: Tensor) -> Tensor:
    """Joint targets [R, S, 7] (rad, gripper in m) from the network's output and [R, 6]."""
    joints = now.unsqueeze(1) + torch.sinh(changes[..., :JOINTS].clamp(-5, 5)) * UNIT_RAD
    grip = torch.where(changes[..., JOINTS:] > 0, OPEN_M, CLOSED_M)
    return torch.cat([joints, grip], -1)
