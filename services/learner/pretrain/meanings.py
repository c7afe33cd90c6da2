"""What prompts mean for each thing: which are wished, in which order, and where they go.

A witness that learning alone has: it must tell the meaning from what the network read. It also
learns from prompts without pictures, which cost nothing, and is thrown away afterwards.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn import functional as F

from services.learner.pretrain.demonstrate import draw
from shared.goals.language.encoder import Encoder
from shared.policies.reading import read_words
from shared.policies.wishes import WISH, Words
from shared.workcell.objects import BIN, COUNT, OBJECT_NAMES, PLATE, TUB
from shared.workcell.tasks import TASKS, understand

PLACES = (PLATE, BIN, TUB)
ORDERS = 8
SKIPPED = -100


class Meanings(NamedTuple):
    """Of B prompts and the fifteen things, O.

    wished: [B, O] float, 0 or 1. told: [B, O] bool, whether the words decide it; "what is on the
    left" does not. order: [B, O] int64, place in the list where order counts, else `SKIPPED`.
    place: [B, O] int64, row of `PLACES` for what is wished, else `SKIPPED`.
    """

    wished: Tensor
    told: Tensor
    order: Tensor
    place: Tensor

    def at(self, rows: Tensor) -> "Meanings":
        """Those of some prompts."""
        return Meanings(*(part[rows] for part in self))


def meanings_of(prompts: Sequence[str]) -> Meanings:
    """What the tasks understand, everything lying there."""
    wished, told = np.zeros((2, len(prompts), COUNT), bool)
    order = np.full((len(prompts), COUNT), SKIPPED)
    place = np.full((len(prompts), COUNT), SKIPPED)
    for row, prompt in enumerate(prompts):
        brief = understand(prompt)
        items = [OBJECT_NAMES.index(name) for name in brief.target]
        wished[row, items] = True
        told[row] = True
        if brief.wish.sides:
            told[row, items] = False
        if brief.ordered:
            order[row, items] = range(len(items))
        for item in items:
            place[row, item] = PLACES.index(TASKS[brief.task].home(item))
    parts = torch.from_numpy(wished).float(), torch.from_numpy(told)
    return Meanings(*parts, torch.from_numpy(order), torch.from_numpy(place))


class Reader(nn.Module):
    """The witness: from what is wanted of a slot to what the prompt means for its thing."""

    def __init__(self) -> None:
        super().__init__()
        self.tell = nn.Linear(WISH, 1 + ORDERS + len(PLACES))

    def loss(self, wishes: Tensor, meanings: Meanings) -> tuple[Tensor, float]:
        """The loss of wishes [B, 18, WISH], and the share of things whose wish was told rightly."""
        told = self.tell(wishes[:, :COUNT].float())
        wished, order, place = told.split([1, ORDERS, len(PLACES)], -1)
        wished, known = wished[..., 0], meanings.told
        missed = F.binary_cross_entropy_with_logits(wished, meanings.wished, reduction="none")
        loss = (missed * known).sum() / known.sum().clamp(min=1)
        for logits, target in ((order, meanings.order), (place, meanings.place)):
            sums = F.cross_entropy(logits.flatten(0, 1), target.flatten(), reduction="sum")
            loss = loss + sums / (target != SKIPPED).sum().clamp(min=1)
        right = ((wished > 0) == (meanings.wished > 0.5))[known].float().mean().item()
        return loss, right


class Prompts:
    """Prompts without pictures, drawn from the tasks, with what they mean."""

    def __init__(self, count: int, seed: int, encoder: Encoder) -> None:
        rng, found = np.random.default_rng([seed, 3]), set[str]()
        tasks = list(TASKS.values())
        for _ in range(count):
            wish = draw(rng)
            able = [task for task in tasks if wish.skills is None or wish.skills in task.lengths]
            found.add(able[int(rng.integers(len(able)))].sample(rng, wish).prompt)
        self.texts = sorted(found)
        self._words, self._meanings = read_words(encoder, self.texts), meanings_of(self.texts)

    def draw(self, count: int, rng: np.random.Generator) -> tuple[Words, Meanings]:
        """Some of them, with replacement."""
        rows = torch.from_numpy(rng.integers(0, len(self.texts), count))
        there = self._words.there[rows]
        longest = int(there.sum(1).max())
        words = Words(self._words.states[rows, :longest], there[:, :longest])
        return words, self._meanings.at(rows)
