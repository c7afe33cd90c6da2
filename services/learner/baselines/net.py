"""One network for all arms: the high level's above, the low level's below, and what links them.

B looks, R rows (a moment and an arm) of the low level's, each of one look. The arms differ in what
passes from the trunk to the mover, and in nothing else.
"""

from typing import NamedTuple

import torch
from torch import Tensor, nn

from services.learner.baselines.scale import ARMS, Arm
from shared.errors import PolicyError
from shared.goals.language.encoder import WIDTH
from shared.policies.checkpoint import Setting, Tensors
from shared.policies.geometry import MEASURES, Geometry, View
from shared.policies.heads import SPREAD, THOUGHT
from shared.policies.high_net import MIND, HighLevelNet
from shared.policies.low_net import LowNet, Motion, Orders
from shared.policies.tokens import OBJECTS

VERB = 64


class Advice(NamedTuple):
    """What the mover is told besides words. verb: [B, 64]. pointing: [B, O + 1] logits of the
    objects and of none; None where words point."""

    verb: Tensor
    pointing: Tensor | None

    def at(self, looks: Tensor) -> "Advice":
        """For rows [R] int64 of looks."""
        return Advice(self.verb[looks], None if self.pointing is None else self.pointing[looks])


class Aside(nn.Module):
    """Chain of thought: the mover hears the goal in words and something of the thought besides."""

    def __init__(self) -> None:
        super().__init__()
        self.verb = nn.Linear(THOUGHT, VERB)

    def forward(self, minds: Tensor, thought: Tensor, meaning: Tensor) -> Advice:
        """minds [B, 18, MIND], thought [B, 256], meaning [B, 384]."""
        del minds, meaning  # Unused: words say it.
        return Advice(self.verb(thought), None)


class Latent(nn.Module):
    """No words: the vector that would be held against phrases says what to do, and points."""

    def __init__(self) -> None:
        super().__init__()
        self.verb = nn.Linear(WIDTH, VERB)
        self.point = nn.Linear(WIDTH, MIND)
        self.nothing = nn.Parameter(torch.zeros(MIND))

    def forward(self, minds: Tensor, thought: Tensor, meaning: Tensor) -> Advice:
        """As `Aside`."""
        del thought  # Unused: the meaning is what there is of it.
        goal = meaning * SPREAD
        keys = torch.cat(
            [minds[:, :OBJECTS], self.nothing.expand(len(minds), 1, -1).to(minds.dtype)], 1
        )
        pointing = (keys @ self.point(goal).unsqueeze(-1).to(keys.dtype)).squeeze(-1)
        return Advice(self.verb(goal), pointing.float() * MIND**-0.5)


class Pair(nn.Module):
    """Trunk and mover of one arm. Parameters that the arm has no use for don't learn."""

    def __init__(self, arm: Arm, geometry: Geometry) -> None:
        super().__init__()
        self.arm = arm
        self.trunk, self.mover = HighLevelNet(), LowNet(geometry)
        self.link: Aside | Latent | None = None
        if arm == "chain":
            self.link = Aside()
        elif arm != "hierarchy":
            self.link = Latent()
        self.trunk.text.requires_grad_(False)
        if not self.labelled:
            self.trunk.temperature.requires_grad_(False)
        if not self.worded:
            self.mover.command.requires_grad_(False)
            self.mover.finished.requires_grad_(False)

    @property
    def worded(self) -> bool:
        """Whether its goals are commands in words."""
        return self.arm in ("hierarchy", "chain")

    @property
    def labelled(self) -> bool:
        """Whether it is told which command was right."""
        return self.worded or self.arm == "guided"

    def learned(self) -> int:
        """How many parameters learn."""
        return sum(part.numel() for part in self.parameters() if part.requires_grad)

    def passed(self, meaning: Tensor, phrases: Tensor, right: Tensor | None = None) -> Tensor:
        """The vector that the mover is advised by, [B, 384]: the meaning, but in the control that
        of a phrase [C, 384], in learning of the right one, in acting of the likeliest one.

        right: rows of phrases, [B]; None: nobody knows.
        """
        if self.arm != "guided":
            return meaning
        return phrases[self.trunk.scores(meaning, phrases).argmax(-1) if right is None else right]

    def advise(self, minds: Tensor, thought: Tensor, meaning: Tensor) -> Advice | None:
        """What the mover is to be told; of a hierarchy nothing but words."""
        return None if self.link is None else self.link(minds, thought, meaning)

    def move(self, view: View, orders: Orders, advice: Advice | None) -> Motion:
        """What an arm does. orders: of no account where advice points."""
        if advice is None or advice.pointing is None:
            motion: Motion = self.mover(view, orders, advice and advice.verb)
            return motion
        return self._follow(view, advice.verb, advice.pointing)

    def _follow(self, view: View, verb: Tensor, pointing: Tensor) -> Motion:
        """As `LowNet.forward`, but where the command points softly, and all kinds are allowed."""
        mover, tokens = self.mover, self.mover.labelled(view)
        there = torch.nn.functional.pad(view.valid[:, :OBJECTS], (0, 1), value=True)
        weights = torch.softmax(pointing.masked_fill(~there, -1e4), -1)[:, :OBJECTS]
        scores = mover.appeal(view, verb)
        liked = scores[..., :OBJECTS] + (weights + 1e-6).log().unsqueeze(1)
        scores = torch.cat([liked, scores[..., OBJECTS:]], -1)
        chosen = torch.softmax(scores.masked_fill(~view.valid.unsqueeze(1), -1e4), -1)
        pointed = (weights.to(tokens.dtype).unsqueeze(1) @ tokens[:, :OBJECTS]).squeeze(1)
        return mover.move(view, tokens, chosen.to(tokens.dtype) @ tokens, pointed, verb)


def build(settings: dict[str, Setting], tensors: Tensors) -> Pair:
    """The pair around its tensors.

    Raises:
        PolicyError: the tensors are not a pair's.
    """
    if settings.get("arm") not in ARMS:
        raise PolicyError(f"no arm {settings.get('arm')!r}: there are {', '.join(ARMS)}")
    try:
        measures = {name: torch.from_numpy(tensors[f"mover.geometry.{name}"]) for name in MEASURES}
        pair = Pair(settings["arm"], Geometry(measures))  # type: ignore[arg-type]  # As written.
        pair.load_state_dict({name: torch.from_numpy(value) for name, value in tensors.items()})
    except (KeyError, RuntimeError) as error:
        raise PolicyError(f"these tensors are no baseline: {error}") from None
    return pair
