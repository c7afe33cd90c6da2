"""Tells which of some classes a short text belongs to, or that it belongs to none of them.

Two ways are averaged: logistic regression on the sentence vector, which finds directions that part
the classes, and the likeness to known texts, which finds what is near to few of them.
"""

from typing import NamedTuple

import numpy as np

from shared.goals.family import Floats
from shared.policies.checkpoint import Tensors
from shared.policies.reader import likeness
from shared.policies.reader.likeness import Likeness

SMALL_WORDS = (
    "not", "don't", "do", "never", "no", "up", "down", "back", "away", "off", "out", "on", "in",
    "over", "and", "or", "both", "it", "there", "hand", "where", "what", "who", "why", "how", "is",
    "are", "you", "me", "it's", "from", "next", "beside", "under", "behind", "near", "above", "but",
    "except",
)  # fmt: skip
"""Words that turn the meaning of a text and hardly its sentence vector."""
SCALE = 5.0
"""Vectors have unit length; this makes them weigh like the small words."""
TINY = 1e-6
DOUBT = 0.02
"""What is known as it stands is in its class but for so much."""


class Linear(NamedTuple):
    """weights [N, D] float32, bias [N] float32."""

    weights: Floats
    bias: Floats

    def __call__(self, x: Floats) -> Floats:
        """Logits [..., N] of [..., D]."""
        answer: Floats = x @ self.weights.T + self.bias
        return answer


class Teller(NamedTuple):
    """C classes and none of them. linear: of `features`. alike: by known texts."""

    linear: Linear
    alike: Likeness

    def chances(self, text: str, vector: Floats) -> Floats:
        """[C + 1] logarithms of probabilities, up to a constant; vector: [D], the sentence's."""
        linear = softmax(self.linear(features(text, vector)))
        alike = self._alike(text, vector)
        answer: Floats = (np.log(linear + TINY) + np.log(alike + TINY)) / 2
        return answer

    def _alike(self, text: str, vector: Floats) -> Floats:
        """[C + 1] probabilities by known texts, of which it may be one."""
        owner = self.alike.owner(text)
        if owner is None:
            return softmax(self.alike.logits(text, vector))
        count = len(self.linear.bias)
        sure = np.full(count, DOUBT / count, np.float32)
        sure[owner] += 1 - DOUBT
        return sure

    def tensors(self, prefix: str) -> Tensors:
        """All that `restore` needs, by name."""
        return {
            f"{prefix}.linear.weight": self.linear.weights,
            f"{prefix}.linear.bias": self.linear.bias,
            **self.alike.tensors(prefix),
        }


def restore(tensors: Tensors, prefix: str) -> Teller:
    """What `Teller.tensors` gave.

    Raises:
        KeyError: something is missing.
    """
    linear = Linear(tensors[f"{prefix}.linear.weight"], tensors[f"{prefix}.linear.bias"])
    return Teller(linear, likeness.restore(tensors, prefix))


def features(text: str, vector: Floats) -> Floats:
    """[D + small words]: a text's sentence vector [D] and which small words are in it."""
    words = set(text.split())
    small = [float(word in words) for word in SMALL_WORDS]
    return np.concatenate([vector * SCALE, small]).astype(np.float32)


def softmax(logits: Floats) -> Floats:
    """Probabilities of logits [N]."""
    grown = np.exp(logits - logits.max())
    answer: Floats = grown / grown.sum()
    return answer
