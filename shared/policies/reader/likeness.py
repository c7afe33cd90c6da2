"""Which of some classes a text belongs to, by the known texts that it is most like.

Likeness is in meaning, by the cosine of sentence vectors less their mean, and in letters, so that a
slip of the finger or a compound ("teacup") still counts. The last class is "none of them".
"""

from collections import defaultdict
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from shared.errors import PolicyError
from shared.goals.family import Floats
from shared.policies.checkpoint import Tensors
from shared.policies.examples import as_bytes, as_texts

NEAREST = (1, 3, 8)
"""Of so many nearest known texts of a class the mean cosine is taken."""
FEATURES = len(NEAREST) + 1


class Likeness:
    """P known texts of C classes and of none of them.

    texts: [P]. owners: [P] int64, C for none of them. vectors: [P, D] float32, unit length.
    weights: [2, F + 1] float32, of the features and of 1: for the classes, and for none of them.
    """

    def __init__(
        self, texts: Sequence[str], owners: NDArray[np.int64], vectors: Floats, weights: Floats
    ) -> None:
        self.texts, self.owners, self.vectors = tuple(texts), owners, vectors
        self.weights = weights
        self._mean = vectors.mean(0)
        self._centred = _unit(vectors - self._mean)
        self._classes = [np.flatnonzero(owners == row) for row in range(int(owners.max()) + 1)]
        self._letters = Letters(texts)
        self._owners = {text: int(owner) for text, owner in zip(self.texts, owners, strict=True)}
        for text, owner in zip(self.texts, owners, strict=True):
            if self._owners.get(text, owner) != owner:  # Some things are called alike.
                self._owners.pop(text, None)

    def owner(self, text: str) -> int | None:
        """The class of a text that is known as it stands, None where it is not or has several."""
        return self._owners.get(text)

    def logits(self, text: str, vector: Floats) -> Floats:
        """[C + 1] of a text and its vector [D]."""
        seen = self.features(text, vector)
        scores = seen @ self.weights[:, :-1].T + self.weights[:, -1]
        answer: Floats = np.append(scores[:-1, 0], scores[-1, 1]).astype(np.float32)
        return answer

    def features(self, text: str, vector: Floats, apart: NDArray[np.bool_] | None = None) -> Floats:
        """[C + 1, F]: how like each class it is. apart: [P], known texts not to look at."""
        cosines = self._centred @ _unit(vector - self._mean)
        letters = self._letters.alike(text)
        if apart is not None:
            cosines, letters = np.where(apart, -1.0, cosines), np.where(apart, 0.0, letters)
        found = np.zeros((len(self._classes), FEATURES), np.float32)
        for row, members in enumerate(self._classes):
            best = -np.sort(-cosines[members])
            found[row] = [*(best[:count].mean() for count in NEAREST), letters[members].max()]
        return found

    def tensors(self, prefix: str) -> Tensors:
        """All that `restore` needs, by name."""
        return {
            f"{prefix}.texts": as_bytes(list(self.texts)),
            f"{prefix}.owners": self.owners,
            f"{prefix}.vectors": _bytes(self.vectors),
            f"{prefix}.weights": self.weights,
        }


def restore(tensors: Tensors, prefix: str) -> Likeness:
    """What `tensors` gave; the vectors are rounded.

    Raises:
        KeyError: something is missing.
    """
    texts = as_texts(tensors[f"{prefix}.texts"])
    vectors = _unit(tensors[f"{prefix}.vectors"].astype(np.float32))
    if len(texts) != len(vectors):
        raise PolicyError(f"{prefix}: {len(texts)} texts, but {len(vectors)} vectors")
    return Likeness(texts, tensors[f"{prefix}.owners"], vectors, tensors[f"{prefix}.weights"])


class Letters:
    """Texts by their runs of three letters; a run counts more the fewer texts have it."""

    def __init__(self, texts: Sequence[str]) -> None:
        runs = [_runs(text) for text in texts]
        holders: dict[str, list[int]] = defaultdict(list)
        for row, found in enumerate(runs):
            for run in found:
                holders[run].append(row)
        self._holders = {run: np.array(rows) for run, rows in holders.items()}
        self._count = len(texts)
        # Of all texts there are few different runs: each is weighed once.
        self._weights = {run: self._weigh(len(rows)) for run, rows in holders.items()}
        self._lengths = np.array([self._length(found) for found in runs])

    def alike(self, text: str) -> NDArray[np.float64]:
        """[P] cosine in [0, 1] of the text's runs and each known text's."""
        runs, common = _runs(text), np.zeros(self._count)
        for run in sorted(runs & self._holders.keys()):  # In the same order, to the last bit.
            common[self._holders[run]] += self._weight(run) ** 2
        alike: NDArray[np.float64] = common / (self._lengths * self._length(runs) + 1e-9)
        return alike

    def _length(self, runs: set[str]) -> float:
        return float(np.sqrt(sum(self._weight(run) ** 2 for run in sorted(runs))))

    def _weight(self, run: str) -> float:
        return self._weights.get(run) or self._weigh(0)

    def _weigh(self, holders: int) -> float:
        """Of a run that so many known texts have."""
        return float(np.log((1 + self._count) / (1 + holders)) + 0.3)


def _bytes(vectors: Floats) -> NDArray[np.int8]:
    """Directions of vectors in bytes; the largest number of each becomes 127."""
    largest = np.abs(vectors).max(-1, keepdims=True)
    whole: NDArray[np.int8] = np.round(vectors * (127 / np.maximum(largest, 1e-6))).astype(np.int8)
    return whole


def _unit(vectors: Floats) -> Floats:
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    answer: Floats = vectors / np.maximum(lengths, 1e-6)
    return answer


def _runs(text: str) -> set[str]:
    text = f" {text} "
    return {text[at : at + 3] for at in range(len(text) - 2)}
