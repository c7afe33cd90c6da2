"""The high level's network: pictures, senses, prompt and last commands in, a meaning out.

B samples, V = 2 views, K earlier looks, O = 18 slots, one for each body of the cell, H previous
commands, D = 384 channels of a sentence vector. Two heads say what to do: a vector in the space of
sentence vectors, so that a new phrase needs no new weights; and words, see `heads`.

Source: Shi et al. 2024 (arXiv 2403.12910): the high level regresses a sentence vector that is
scored against a bank by cosine and a learned temperature, from the present and earlier looks.
Theirs sees through CLIP and a transformer; ours is small enough for a CPU, trained from scratch.
"""

from typing import NamedTuple

import torch
from torch import Tensor, nn
from torch.nn import functional as F

from shared.goals.language.encoder import WIDTH
from shared.policies.heads import THOUGHT, TextHead
from shared.policies.wishes import SLOTS, WISH, Attention, Wishes, Words

VIEWS, SENSES = 2, 22
SIGHT, NAME, SCENE, GLIMPSE = 32, 8, 16, 32
FELT, PAST, CONTEXT, MIND = 48, 64, 96, 96


class Sights(NamedTuple):
    """What eyes made of pictures, and what need not be seen again where they are frozen.

    eyes: [B, O, V * 82], of the present look. glances: [B, K + 1, V * 32], of all looks.
    """

    eyes: Tensor
    glances: Tensor


class Question(NamedTuple):
    """What the network is asked about.

    images: [B, V, 64, 64, 3] uint8 or float 0..255, the present look.
    glimpses: [B, K + 1, V, 32, 32, 3] likewise, earlier looks, oldest first, and the present one.
    seen: [B, K + 1] bool, which of them there are. senses: [B, 22] float32, proprioception.
    words: of the prompts.
    previous: [B, H, D], oldest first, zeros where there was none.
    sights: of the pictures, where eyes have seen them before; then the pictures are of no account.
    """

    images: Tensor
    glimpses: Tensor
    seen: Tensor
    senses: Tensor
    words: Words
    previous: Tensor
    sights: Sights | None = None


class Answer(NamedTuple):
    """meaning: of the next command, unit vectors [B, D]. thought: for the text head, [B, 256]."""

    meaning: Tensor
    thought: Tensor


class HighLevelNet(nn.Module):
    """Sees a slot for each body, asks of each what the prompt wants of it, and says what to do.

    history: H, previous commands that it is shown. looks: K + 1. words: of its text head.
    sense_mean, sense_scale: what joints and tools are like on average, see `learn_senses`.
    """

    sense_mean: Tensor
    sense_scale: Tensor

    def __init__(self, history: int = 4, looks: int = 4, words: tuple[str, ...] = ()) -> None:
        super().__init__()
        self.history, self.looks = history, looks
        self.register_buffer("sense_mean", torch.zeros(SENSES))
        self.register_buffer("sense_scale", torch.ones(SENSES))
        self.eyes = nn.ModuleList(_Eye() for _ in range(VIEWS))
        self.glance = _glance()
        self.name = nn.Parameter(torch.randn(SLOTS, NAME) * 0.3)
        self.sight = nn.Sequential(
            nn.Linear(VIEWS * (_Eye.EACH + SCENE) + NAME, 64), nn.GELU(), nn.Linear(64, SIGHT)
        )
        self.wishes = Wishes()
        self.feel = nn.Sequential(nn.Linear(SENSES, FELT), nn.GELU())
        self.past = nn.Sequential(nn.Linear(history * WIDTH, PAST), nn.GELU())
        self.before = nn.Sequential(nn.Linear(looks * (VIEWS * GLIMPSE + 1), PAST), nn.GELU())
        self.context = nn.Sequential(nn.Linear(FELT + 2 * PAST, CONTEXT), nn.GELU())
        self.enter = nn.Linear(SIGHT + WISH + NAME + CONTEXT, MIND)
        self.minds = nn.ModuleList(Attention(MIND, 4) for _ in range(2))
        self.weigh = nn.Sequential(nn.LayerNorm(MIND), nn.Linear(MIND, 32), nn.GELU())
        self.think = nn.Sequential(nn.Linear(SLOTS * 32 + CONTEXT, THOUGHT), nn.GELU())
        self.speak = nn.Linear(THOUGHT, WIDTH)
        self.temperature = nn.Parameter(torch.tensor(-2.5))
        self.text = TextHead(words)

    def learn_senses(self, senses: Tensor) -> None:
        """Take what is usual from the demonstrations, [N, 22]."""
        self.sense_mean.copy_(senses.mean(0))
        self.sense_scale.copy_(senses.std(0).clamp(min=1e-3))

    def see(self, images: Tensor) -> Tensor:
        """What the slots look like, [B, O, SIGHT]."""
        return self.slots(self.look(images))

    def look(self, images: Tensor) -> Tensor:
        """What the eyes make of the present look, [B, O, V * 82]."""
        return torch.cat([eye(_pixels(images[:, row])) for row, eye in enumerate(self.eyes)], -1)

    def glimpse(self, glimpses: Tensor) -> Tensor:
        """What the small eye makes of some looks, [B, K, V, 32, 32, 3] to [B, K, V * 32]."""
        glances: Tensor = self.glance(_pixels(glimpses.flatten(0, 2)))
        return glances.reshape(*glimpses.shape[:2], -1)

    @property
    def glance_width(self) -> int:
        """Numbers of one look in `glimpse`."""
        return VIEWS * GLIMPSE

    def slots(self, eyes: Tensor) -> Tensor:
        """What the slots look like to these eyes, [B, O, SIGHT]."""
        names = self.name.expand(len(eyes), -1, -1)
        slots: Tensor = self.sight(torch.cat([eyes, names], -1))
        return slots

    def wish(self, words: Words) -> Tensor:
        """What the prompt wants of each slot, [B, O, WISH]."""
        wishes: Tensor = self.wishes(words)
        return wishes

    def forward(self, question: Question) -> Answer:
        """What to do next."""
        sights = question.sights
        slots = self.slots(sights.eyes) if sights else self.see(question.images)
        return self.decide(slots, self.wish(question.words), question)

    def decide(self, slots: Tensor, wishes: Tensor, question: Question) -> Answer:
        """From slots and wishes to the answer; of the question it takes the rest."""
        return self.answer(self.ponder(slots, wishes, question)[1])

    def answer(self, thought: Tensor) -> Answer:
        """What a thought [B, 256] says."""
        return Answer(F.normalize(self.speak(thought).float(), dim=-1), thought)

    def ponder(self, slots: Tensor, wishes: Tensor, question: Question) -> tuple[Tensor, Tensor]:
        """The slots after they exchanged what they know, [B, O, MIND]; the thought, [B, 256]."""
        context = self._context(question)
        names = self.name.expand(len(slots), -1, -1)
        everywhere = context.unsqueeze(1).expand(-1, SLOTS, -1)
        minds = self.enter(torch.cat([slots, wishes, names, everywhere], -1))
        for mind in self.minds:
            minds = mind(minds)
        thought = self.think(torch.cat([self.weigh(minds).flatten(1), context], -1))
        return minds, thought

    def scores(self, meaning: Tensor, bank: Tensor) -> Tensor:
        """Logits of the bank's phrases [C, D], [B, C]: cosine by the learned temperature."""
        return meaning @ bank.T / self.temperature.exp().clamp(0.01, 1.0)

    def _context(self, question: Question) -> Tensor:
        """What holds for all slots: how the arms are, and what was said and seen, [B, CONTEXT]."""
        felt = self.feel((question.senses - self.sense_mean) / self.sense_scale)
        said = self.past(question.previous.flatten(1))
        context: Tensor = self.context(torch.cat([felt, said, self._glances(question)], -1))
        return context

    def _glances(self, question: Question) -> Tensor:
        """What moved: the present and the earlier looks through one small eye, [B, PAST]."""
        sights = question.sights
        glances = sights.glances if sights else self.glimpse(question.glimpses)
        seen = question.seen.to(glances.dtype)
        shown = glances * seen[..., None]
        before: Tensor = self.before(torch.cat([shown.flatten(1), seen], -1))
        return before


class _Eye(nn.Module):
    """One view of 64 x 64. Each slot looks where its thing may be; a second path keeps the whole.

    Source: spatial soft-argmax of Finn et al. 2016 (arXiv 1509.06113), here with the features of
    the place it finds.
    """

    EACH = 64 + 2
    grid: Tensor

    def __init__(self) -> None:
        super().__init__()
        self.near = nn.Sequential(
            nn.Conv2d(3, 64, 6, 4, 1), nn.ReLU(), nn.Conv2d(64, 64, 3, 1, 1), nn.ReLU()
        )
        self.find = nn.Parameter(torch.randn(SLOTS, 64) * 0.1)
        self.whole = nn.Sequential(
            nn.Conv2d(64, 48, 3, 2, 1),
            nn.ReLU(),
            nn.Flatten(),
            nn.Linear(48 * 64, 96),
            nn.ReLU(),
            nn.Linear(96, SLOTS * SCENE),
        )
        line = torch.linspace(-1, 1, 16)
        grid = torch.stack(torch.meshgrid(line, line, indexing="ij"), -1).reshape(256, 2)
        self.register_buffer("grid", grid, persistent=False)

    def forward(self, pixels: Tensor) -> Tensor:
        """pixels [B, 3, 64, 64] to what each slot sees here, [B, O, EACH + SCENE]."""
        near = self.near(pixels)
        spots = near.flatten(2).transpose(1, 2)
        where = torch.matmul(self.find, spots.transpose(1, 2)).softmax(-1)
        features, place = where.to(spots.dtype) @ spots, where.float() @ self.grid
        whole = self.whole(near).unflatten(-1, (SLOTS, SCENE))
        return torch.cat([features, place, whole], -1)


def _glance() -> nn.Sequential:
    """One view of 32 x 32, for what changes from look to look."""
    return nn.Sequential(
        nn.Conv2d(3, 32, 4, 4),
        nn.ReLU(),
        nn.Conv2d(32, 16, 3, 1, 1),
        nn.ReLU(),
        nn.Flatten(),
        nn.Linear(16 * 64, GLIMPSE),
        nn.ReLU(),
    )


def _pixels(images: Tensor) -> Tensor:
    """Pictures [N, H, W, 3] of 0..255 as the eyes take them, [N, 3, H, W], channels last."""
    pixels = images.permute(0, 3, 1, 2)
    return (pixels if pixels.is_floating_point() else pixels.float()) / 64.0 - 2.0
