"""The high level's network: two pictures, the prompt and the last commands in, a meaning out.

B samples, V = 2 views, O = 7 slots, H previous commands, D = 384 channels of a sentence vector.
The output lies in the space of sentence vectors, so a new phrase needs no new weights.

Source: Shi et al. 2024 (arXiv 2403.12910): the high level regresses a sentence vector that is
scored against a bank by cosine and a learned temperature. Theirs sees through CLIP and a
transformer; ours is small enough for a CPU and is trained from scratch.
"""

from typing import NamedTuple

import torch
from torch import Tensor, nn
from torch.nn import functional as F

WORDS = 384
SLOTS = 7
VIEWS = 2
SIGHT, ASK, NAME, PAST, MIND = 24, 12, 8, 64, 48


class Question(NamedTuple):
    """What the network is asked about.

    images: [B, V, 64, 64, 3] uint8. prompts: [B, D]. previous: [B, H, D], oldest first, zeros
    where there was none.
    """

    images: Tensor
    prompts: Tensor
    previous: Tensor


class HighLevelNet(nn.Module):
    """Sees seven slots, asks of each what the prompt wants of it, and says what to do.

    history: H, previous commands that it is shown. reading: width of the whitened prompt.
    ease, ask_mean: whitening of prompts, see `learn_prompts`; without it the order of the
    words in a prompt would be drowned out.
    """

    ask_mean: Tensor
    ease: Tensor

    def __init__(self, history: int = 4, reading: int = 96) -> None:
        super().__init__()
        self.history, self.reading = history, reading
        self.register_buffer("ask_mean", torch.zeros(WORDS))
        self.register_buffer("ease", torch.eye(WORDS)[:, :reading].contiguous())
        self.eyes = nn.ModuleList(_eye() for _ in range(VIEWS))
        self.sight = nn.Linear(VIEWS * 128, SLOTS * SIGHT)
        self.ask = nn.Linear(reading, SLOTS * ASK)
        self.name = nn.Parameter(torch.randn(SLOTS, NAME) * 0.3)
        self.past = nn.Sequential(nn.Linear(history * WORDS, PAST), nn.GELU())
        each = SIGHT + ASK + NAME + PAST
        self.think = nn.Sequential(nn.Linear(each, 96), nn.GELU(), nn.Linear(96, MIND), nn.GELU())
        self.again = nn.Sequential(
            nn.Linear(2 * MIND + each, 96), nn.GELU(), nn.Linear(96, MIND), nn.GELU()
        )
        self.speak = nn.Sequential(
            nn.Linear(SLOTS * MIND + MIND + PAST, 256), nn.GELU(), nn.Linear(256, WORDS)
        )
        self.temperature = nn.Parameter(torch.tensor(-2.5))

    def learn_prompts(self, prompts: Tensor) -> None:
        """Take mean and whitening from the prompts of the demonstrations, [N, D]."""
        self.ask_mean.copy_(prompts.mean(0))
        _, sizes, axes = torch.linalg.svd(prompts - self.ask_mean, full_matrices=False)
        spread = sizes / len(prompts) ** 0.5
        kept = min(self.reading, len(axes))
        self.ease.zero_()
        self.ease[:, :kept] = axes[:kept].T / (spread[:kept] + 0.3 * spread[:kept].mean())

    def see(self, images: Tensor) -> Tensor:
        """What the slots look like, [B, O, SIGHT]."""
        pixels = images.permute(0, 1, 4, 2, 3).to(torch.float32) / 64.0 - 2.0
        views = [eye(_last(pixels[:, row])) for row, eye in enumerate(self.eyes)]
        slots: Tensor = self.sight(torch.cat(views, -1)).unflatten(-1, (SLOTS, SIGHT))
        return slots

    def wish(self, prompts: Tensor) -> Tensor:
        """What the prompt wants of each slot, [B, O, ASK]."""
        easy = (prompts - self.ask_mean) @ self.ease
        wishes: Tensor = self.ask(easy).unflatten(-1, (SLOTS, ASK))
        return wishes

    def forward(self, question: Question) -> Tensor:
        """The meaning of the next command, unit vectors [B, D]."""
        return self.decide(
            self.see(question.images), self.wish(question.prompts), question.previous
        )

    def decide(self, slots: Tensor, wishes: Tensor, previous: Tensor) -> Tensor:
        """From slots and wishes to the meaning, unit vectors [B, D]."""
        past = self.past(previous.flatten(1))
        count = len(slots)
        names = self.name.expand(count, -1, -1)
        each = torch.cat([slots, wishes, names, past.unsqueeze(1).expand(-1, SLOTS, -1)], -1)
        first = self.think(each)
        shared = first.mean(1, keepdim=True).expand_as(first)
        second = self.again(torch.cat([first, shared, each], -1))
        meaning = self.speak(torch.cat([second.flatten(1), second.mean(1), past], -1))
        return F.normalize(meaning.float(), dim=-1)

    def scores(self, meaning: Tensor, bank: Tensor) -> Tensor:
        """Logits of the bank's phrases [C, D], [B, C]: cosine by the learned temperature."""
        return meaning @ bank.T / self.temperature.exp().clamp(0.01, 1.0)


def _eye() -> nn.Sequential:
    """One view of 64 x 64: position is kept, since where a thing lies is what matters."""
    return nn.Sequential(
        nn.Conv2d(3, 24, 5, 2, 2),
        nn.ReLU(),
        nn.Conv2d(24, 48, 3, 2, 1),
        nn.ReLU(),
        nn.Conv2d(48, 64, 3, 1, 1),
        nn.ReLU(),
        nn.Conv2d(64, 64, 3, 2, 1),
        nn.ReLU(),
        nn.Flatten(),
        nn.Linear(64 * 64, 128),
        nn.ReLU(),
    )


def _last(pixels: Tensor) -> Tensor:
    return pixels.contiguous(memory_format=torch.channels_last)
