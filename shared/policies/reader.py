"""Reads a phrase as one of the commands that the low level knows, or refuses it.

A phrase means the command whose known phrases are nearest to it as sentence vectors. What lies
in the scene narrows the choice; what is near to nothing is refused.
"""

import threading
from collections import OrderedDict
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from shared.errors import PolicyError
from shared.goals.family import Floats, GoalFamily
from shared.messages.goal import Goal
from shared.policies.checkpoint import Tensors
from shared.policies.examples import as_bytes, as_texts

NEAREST = 3
REMEMBERED = 4096


class Reading(NamedTuple):
    """What a phrase was taken for.

    command: row of the command, None where it was refused. scores: [C] float32 in [-1, 1], of each
    command, whether possible or not.
    """

    command: int | None
    scores: Floats


class Reader:
    """Knows C commands by P phrases. Pure, and safe to use from several threads; remembers.

    commands: their canonical texts. verbs: [C] rows of `low_net.VERBS`. things: [C] the row of the
    object that each is about, -1 for none. phrases: the canonical text of each command among them.
    owners: [P] the command of each phrase, -1 for what is to be refused.
    vectors: [P, D] float32, unit length.
    threshold: least score of what is not refused.
    """

    def __init__(
        self,
        commands: Sequence[str],
        verbs: NDArray[np.int64],
        things: NDArray[np.int64],
        phrases: Sequence[str],
        owners: NDArray[np.int64],
        vectors: Floats,
        threshold: float,
        family: GoalFamily,
    ) -> None:
        self.commands, self.verbs, self.things = tuple(commands), verbs, things
        self._phrases, self._owners, self._vectors = tuple(phrases), owners, vectors
        self._threshold, self._family = threshold, family
        self._rows = {_plain(text): row for row, text in enumerate(phrases)}
        self._lock = threading.Lock()
        self._seen: OrderedDict[str, tuple[Floats, float]] = OrderedDict()

    def read(self, text: str, there: NDArray[np.bool_]) -> Reading:
        """The command that a phrase means among those that are possible.

        there: [18] bool, what is in the scene.
        """
        scores, strange = self._scores(text)
        row = self._rows.get(_plain(text))
        if row is not None and self._owners[row] >= 0:
            return Reading(int(self._owners[row]), scores)
        possible = np.where(self.possible(there), scores, -1.0)
        best = int(possible.argmax())
        clear = possible[best] >= max(self._threshold, strange)
        return Reading(best if clear else None, scores)

    def possible(self, there: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """[C] Which commands are about nothing that is missing."""
        needs = np.where(self.things >= 0, self.things, 0)
        answer: NDArray[np.bool_] = (self.things < 0) | there[needs]
        return answer

    def nearest(self, scores: Floats, there: NDArray[np.bool_]) -> list[tuple[str, float]]:
        """The commands that a phrase is nearest to, and are possible, with their scores."""
        order = np.argsort(-np.where(self.possible(there), scores, -2.0), kind="stable")
        return [(self.commands[row], float(scores[row])) for row in order[:NEAREST]]

    def _scores(self, text: str) -> tuple[Floats, float]:
        """Of each command its nearest phrase's cosine, and the nearest of those to be refused."""
        with self._lock:
            known = self._seen.get(text)
        if known is None:
            row = self._rows.get(_plain(text))
            # A known phrase needs no encoder: the control loop doesn't wait for it.
            vector = (
                self._family.embed((Goal(text=text),))[0] if row is None else self._vectors[row]
            )
            best = np.full(len(self.commands) + 1, -1.0, np.float32)
            np.maximum.at(best, self._owners, self._vectors @ vector)  # -1 is the last one.
            known = best[:-1], float(best[-1])
            with self._lock:
                self._seen[text] = known
                while len(self._seen) > REMEMBERED:
                    self._seen.popitem(last=False)
        return known

    def tensors(self) -> Tensors:
        """All that `restore` needs, by name."""
        return {
            "reader.commands": as_bytes(list(self.commands)),
            "reader.verbs": self.verbs,
            "reader.things": self.things,
            "reader.phrases": as_bytes(list(self._phrases)),
            "reader.owners": self._owners,
            "reader.vectors": self._vectors.astype(np.float16),
            "reader.threshold": np.array([self._threshold], np.float32),
        }


def restore(tensors: Tensors, family: GoalFamily) -> Reader:
    """The reader among the tensors of a low level.

    Raises:
        PolicyError: they hold none.
    """
    try:
        return Reader(
            as_texts(tensors["reader.commands"]),
            tensors["reader.verbs"],
            tensors["reader.things"],
            as_texts(tensors["reader.phrases"]),
            tensors["reader.owners"],
            tensors["reader.vectors"].astype(np.float32),
            float(tensors["reader.threshold"][0]),
            family,
        )
    except KeyError as error:
        raise PolicyError(f"these tensors hold no reader: {error} is missing") from None


def _plain(text: str) -> str:
    return " ".join(text.lower().split()).rstrip(".!")
