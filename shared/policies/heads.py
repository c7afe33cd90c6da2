"""The text head: says a command word by word, as Hi Robot does, over a small vocabulary.

B samples, L words, W words of the vocabulary. Its words are vectors of the sentence encoder and
something learned of its own, so that a word which a person brings in begins near what it means.

Source: Shi et al. 2025 (Hi Robot, arXiv 2502.19417), whose high level is a language model.
"""

from collections.abc import Iterable, Sequence

import torch
from torch import Tensor, nn
from torch.nn import functional as F

from shared.errors import PolicyError
from shared.goals.language.encoder import WIDTH, Encoder

EMBEDDED, HIDDEN, THOUGHT = 64, 128, 256
BEAMS, MOST_WORDS = 24, 16
SPREAD = WIDTH**0.5
"""Unit vectors times this have numbers about 1 in size, as layers like them."""
END = 0
"""Row of the mark that ends a phrase; words follow in the order of the vocabulary."""


class TextHead(nn.Module):
    """A thought [B, 256] in, words out. words: the vocabulary, in the order of its rows."""

    vectors: Tensor

    def __init__(self, words: Sequence[str] = ()) -> None:
        super().__init__()
        self.words = tuple(words)
        self.register_buffer("vectors", torch.zeros(len(self.words), WIDTH))
        self.own = nn.Parameter(torch.randn(len(self.words) + 1, EMBEDDED) * 0.1)
        self.enter = nn.Linear(WIDTH, EMBEDDED)
        self.begin = nn.Linear(THOUGHT, HIDDEN)
        self.cell = nn.GRU(EMBEDDED, HIDDEN, batch_first=True)
        self.leave = nn.Linear(HIDDEN, EMBEDDED)

    def learn(self, phrases: Iterable[str], encoder: Encoder) -> None:
        """Take in the words of these phrases that are new."""
        known = dict.fromkeys(self.words)
        fresh = [*dict.fromkeys(word for text in phrases for word in text.split())]
        fresh = [word for word in fresh if word not in known]
        if fresh:
            vectors = torch.from_numpy(encoder.embed(fresh))
            self.words += tuple(fresh)
            self.vectors = torch.cat([self.vectors, vectors])
            rows = torch.zeros(len(fresh), EMBEDDED)
            self.own = nn.Parameter(torch.cat([self.own.detach(), rows]))

    def rows(self, phrases: Sequence[str]) -> Tensor:
        """Phrases as rows of the vocabulary, each closed by `END`, padded with -1: [C, L] int64.

        Raises:
            PolicyError: a word is not in the vocabulary, or a phrase is too long.
        """
        number = {word: row for row, word in enumerate(self.words, 1)}
        said = [text.split() for text in phrases]
        unknown = sorted({word for words in said for word in words} - set(number))
        long = next((" ".join(words) for words in said if len(words) > MOST_WORDS), None)
        if unknown:
            raise PolicyError(f"words that the text head does not know: {', '.join(unknown)}")
        if long is not None:
            raise PolicyError(f"a phrase has at most {MOST_WORDS} words; this one more: {long!r}")
        rows = torch.full((len(said), 1 + max(map(len, said))), -1)
        for row, words in zip(rows, said, strict=True):
            row[: len(words) + 1] = torch.tensor([*(number[word] for word in words), END])
        return rows

    def loss(self, thoughts: Tensor, rows: Tensor) -> Tensor:
        """Mean over samples of `nats`."""
        return self.nats(thoughts, rows).mean()

    def nats(self, thoughts: Tensor, rows: Tensor) -> Tensor:
        """-log p of what each should say, [B]; rows [B, L] as from `rows`."""
        table = self._table()
        heard = table[rows[:, :-1].clamp(min=END)]
        first = torch.zeros(len(rows), 1, EMBEDDED)
        hidden, _ = self.cell(torch.cat([first, heard], 1), self._start(thoughts))
        logits = self.leave(hidden) @ table.T
        each = F.cross_entropy(
            logits.flatten(0, 1), rows.flatten(), ignore_index=-1, reduction="none"
        )
        return each.reshape(rows.shape).sum(1)

    def phrases(self, thought: Tensor) -> list[tuple[str, float]]:
        """The most probable phrases and their probabilities, best first; at least one.

        thought: [1, 256]. By beam search; the probabilities sum to at most 1, the rest is with
        phrases that were not found.
        """
        table = self._table()
        said, scores = [()], torch.zeros(1, dtype=torch.float64)
        step, hidden = torch.zeros(1, 1, EMBEDDED), self._start(thought)
        done: list[tuple[str, float]] = []
        for length in range(MOST_WORDS + 1):
            out, hidden = self.cell(step, hidden)
            logits = (self.leave(out[:, 0]) @ table.T).double()
            shares = scores[:, None] + torch.log_softmax(logits, -1)
            if length:  # Nothing at all is no phrase.
                ended = zip(said, shares[:, END].exp().tolist(), strict=True)
                done += [(self._text(rows), share) for rows, share in ended]
            if length == MOST_WORDS:
                break
            shares[:, END] = -torch.inf
            scores, order = shares.flatten().topk(min(BEAMS, len(said) * len(self.words)))
            parents, words = order // shares.shape[1], order % shares.shape[1]
            said = [
                (*said[parent], word)
                for parent, word in zip(parents.tolist(), words.tolist(), strict=True)
            ]
            step, hidden = table[words][:, None], hidden[:, parents]
            best = sorted((share for _, share in done), reverse=True)[:BEAMS]
            if len(best) == BEAMS and float(scores[0].exp()) <= best[-1]:
                break  # Nothing that is still being said can come among the best.
        return sorted(done, key=lambda one: -one[1])[:BEAMS]

    def _text(self, rows: Sequence[int]) -> str:
        return " ".join(self.words[row - 1] for row in rows)

    def _start(self, thoughts: Tensor) -> Tensor:
        return torch.tanh(self.begin(thoughts.float()))[None].contiguous()

    def _table(self) -> Tensor:
        """What stands for the end and for each word, [W + 1, EMBEDDED]."""
        return self.own + F.pad(self.enter(self.vectors * SPREAD), (0, 0, 1, 0))
