"""What a prompt wants of each thing: slots that read its words, and not one vector of it all.

B samples, T word pieces, O = 18 slots, one for each body of the cell, W = 64 channels inside.
A pooled sentence vector can't tell "no tomato" from "tomato"; a slot that looks for its own words
and for those beside them can.

Source: cross-attention of learned queries as in Jaegle et al. 2021 (Perceiver, arXiv 2103.03206).
"""

import math
from typing import NamedTuple

import torch
from torch import Tensor, nn

from shared.goals.language.encoder import MAX_PIECES, TOKEN_WIDTH

SLOTS = 18
WISH = 32
WIDTH, HEADS = 64, 4


class Words(NamedTuple):
    """Prompts word piece by word piece.

    states: [B, T, 768] bfloat16, of the frozen encoder, each row with mean 0 and spread 1.
    there: [B, T] bool.
    """

    states: Tensor
    there: Tensor


class Attention(nn.Module):
    """Rows that ask other rows, or each other, and then think; pre-norm, residual."""

    def __init__(self, width: int, heads: int) -> None:
        super().__init__()
        self.heads = heads
        self.norm, self.norm_mlp = nn.LayerNorm(width), nn.LayerNorm(width)
        self.ask, self.tell = nn.Linear(width, width), nn.Linear(width, 2 * width)
        self.take = nn.Linear(width, width)
        self.mlp = nn.Sequential(
            nn.Linear(width, 2 * width), nn.GELU(), nn.Linear(2 * width, width)
        )

    def forward(
        self, x: Tensor, other: Tensor | None = None, there: Tensor | None = None
    ) -> Tensor:
        """x [B, O, W] after it asked `other` [B, T, W], None: itself; there [B, T] bool."""
        asking = self.norm(x)
        query = self._split(self.ask(asking))
        key, value = map(self._split, self.tell(asking if other is None else other).chunk(2, -1))
        # By hand: the fused kernel's backward pass is ten times slower on a CPU.
        fit = query @ key.transpose(-1, -2) * query.shape[-1] ** -0.5
        if there is not None:
            fit = fit.masked_fill(~there[:, None, None, :], -torch.inf)
        mixed = fit.softmax(-1).to(value.dtype) @ value
        x = x + self.take(mixed.transpose(1, 2).flatten(-2))
        thought: Tensor = x + self.mlp(self.norm_mlp(x))
        return thought

    def _split(self, x: Tensor) -> Tensor:
        return x.reshape(*x.shape[:2], self.heads, -1).transpose(1, 2)


class Wishes(nn.Module):
    """Reads the words twice for every slot; in between the slots hear of each other."""

    places: Tensor

    def __init__(self) -> None:
        super().__init__()
        self.register_buffer("places", _places(MAX_PIECES, WIDTH), persistent=False)
        self.enter = nn.Linear(TOKEN_WIDTH, WIDTH)
        self.slots = nn.Parameter(torch.randn(SLOTS, WIDTH))
        self.first, self.second = Attention(WIDTH, HEADS), Attention(WIDTH, HEADS)
        self.between = Attention(WIDTH, HEADS)
        self.norm, self.leave = nn.LayerNorm(WIDTH), nn.Linear(WIDTH, WISH)

    def forward(self, words: Words) -> Tensor:
        """What is wanted of each slot, [B, O, WISH]."""
        count, length = words.there.shape
        width = self.enter.weight.dtype  # Under autocast the states are as they should be.
        states = words.states if torch.is_autocast_enabled("cpu") else words.states.to(width)
        heard = self.enter(states) + self.places[:length]
        x = self.first(self.slots.expand(count, -1, -1), heard, words.there)
        x = self.second(self.between(x), heard, words.there)
        wishes: Tensor = self.leave(self.norm(x))
        return wishes


def _places(count: int, width: int) -> Tensor:
    """Where a word piece stands, as sines, [count, width] (Vaswani et al. 2017)."""
    rates = torch.exp(torch.arange(0, width, 2) * (-math.log(200.0) / width))
    angles = torch.arange(count)[:, None] * rates
    return torch.cat([angles.sin(), angles.cos()], -1)
