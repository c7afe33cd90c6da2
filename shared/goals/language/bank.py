"""The phrases that a high level can choose from, as vectors; it grows without new weights."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from shared.errors import PolicyError, nearest
from shared.goals.family import Floats
from shared.goals.language.encoder import Encoder, shared_encoder


class Match(NamedTuple):
    """A phrase of the bank and its cosine to what was asked for."""

    phrase: str
    score: float


@dataclass(frozen=True, eq=False)
class PhraseBank:
    """Phrases in a fixed order; a snapshot of it belongs to each version of a high level.

    phrases: C different texts. vectors: [C, 384] float32, each of length 1.
    """

    phrases: tuple[str, ...]
    vectors: Floats

    @classmethod
    def of(cls, phrases: Iterable[str], encoder: Encoder | None = None) -> "PhraseBank":
        """A bank of these phrases, read by the sentence encoder."""
        phrases = tuple(phrases)
        vectors = (encoder or shared_encoder()).embed(phrases)
        vectors.setflags(write=False)
        return cls(phrases, vectors)

    def __post_init__(self) -> None:
        if not self.phrases or len(set(self.phrases)) != len(self.phrases):
            raise PolicyError("a phrase bank holds at least one phrase, and each only once")
        if self.vectors.shape[0] != len(self.phrases):
            raise PolicyError(f"{len(self.phrases)} phrases, but {len(self.vectors)} vectors")

    def __len__(self) -> int:
        return len(self.phrases)

    def index(self, phrase: str) -> int:
        """Row of `phrase`.

        Raises:
            PolicyError: the bank does not hold it; the message names the nearest.
        """
        try:
            return self.phrases.index(phrase)
        except ValueError:
            hint = nearest(phrase, self.phrases)
            raise PolicyError(f"the bank does not hold {phrase!r}{hint}") from None

    def add(self, phrase: str, encoder: Encoder | None = None) -> "PhraseBank":
        """A bank with `phrase` at its end; the same bank where it holds it already."""
        if phrase in self.phrases:
            return self
        vector = (encoder or shared_encoder()).embed([phrase])
        return PhraseBank((*self.phrases, phrase), np.concatenate([self.vectors, vector]))

    def nearest(self, text: str, k: int = 3, encoder: Encoder | None = None) -> tuple[Match, ...]:
        """The `k` phrases that mean most nearly the same as `text`, best first.

        For a person to choose from; a match is never obeyed unasked.
        """
        scores = self.vectors @ (encoder or shared_encoder()).embed([text])[0]
        order = np.argsort(-scores, kind="stable")[:k]
        return tuple(Match(self.phrases[row], float(scores[row])) for row in order)
