"""Reads a person's phrase as one of the commands that the low level knows, or refuses it.

The phrase is taken apart by the states of its words: courtesy is dropped; the frame, with a word
that stands for each thing and place, tells what to do; and thing and place are told by the known
names that they are most like. What lies in the scene narrows the choice; what is like nothing
known, or most like what nobody here can do, is refused.
"""

import re
from collections import OrderedDict
from collections.abc import Iterable, Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from shared.errors import PolicyError
from shared.goals.family import Floats
from shared.policies import tagger, teller
from shared.policies.checkpoint import Tensors
from shared.policies.examples import as_bytes, as_texts
from shared.policies.phrase import Parts, plain, take_apart, words_of
from shared.policies.spelling import corrected
from shared.policies.tagger import Tagger
from shared.policies.teller import Teller, softmax

NEAREST = 3
REMEMBERED = 4096
ACTS = ("pick", "put", "plate", "bin", "tub", "down", "wait", "refuse")
"""What a phrase may ask for; to put something somewhere is told further by the place."""
PLACES = ("plate", "bin", "tub", "down")
THINGS = 15
PUTS = THINGS + np.arange(len(PLACES))  # Rows of the commands that put, in the order of PLACES.
WAIT_ROW = THINGS + len(PLACES)
ABSENT = 2.0
"""By so much less likely, in logits, a thing is meant that isn't in the scene."""
LEAST = 0.3
"""A command that is less probable is refused."""


class Sentences(Protocol):
    """Reads sentences; the encoder of `shared.goals.language` is one."""

    def embed(self, sentences: Iterable[str]) -> Floats:
        """Unit vectors, [N, D] float32."""
        ...

    def is_word(self, text: str) -> bool:
        """Whether it is a common word."""
        ...

    def states(self, sentence: str) -> Floats:
        """What each of its words means where it stands, [W, S] float32."""
        ...


class Reading(NamedTuple):
    """What a phrase was taken for.

    command: row of the command, None where it was refused. scores: [C] float32 in [0, 1], of each
    command its probability.
    """

    command: int | None
    scores: Floats


class _Taken(NamedTuple):
    """A phrase as understood without its scene: logits of acts [8], of each thing [15 + 1] and
    each place [4 + 1] that it names."""

    acts: Floats
    things: tuple[Floats, ...]
    places: tuple[Floats, ...]


class Reader:
    """Knows twenty commands. Pure; remembers what it read.

    commands: their canonical texts. verbs: [20] rows of `low_net.VERBS`. things: [20] the row of
    the body that each is about, -1 for none.
    parts: tells the part of each word. acts: what a frame asks for. names, places: which thing or
    place is named.
    """

    def __init__(
        self,
        commands: Sequence[str],
        verbs: NDArray[np.int64],
        things: NDArray[np.int64],
        parts: Tagger,
        acts: Teller,
        names: Teller,
        places: Teller,
        encoder: Sentences,
    ) -> None:
        self.commands, self.verbs, self.things = tuple(commands), verbs, things
        self._parts, self._acts, self._names, self._places = parts, acts, names, places
        self._encoder = encoder
        self._known = {
            word
            for known in (acts, names, places)
            for text in known.alike.texts
            for word in words_of(text)
        }
        self._seen: OrderedDict[str, _Taken] = OrderedDict()

    def read(self, text: str, there: NDArray[np.bool_]) -> Reading:
        """The command that a phrase means, which may be about what is missing in the scene.

        there: [18] bool, what is in the scene.
        """
        said = self.spelt(text)
        if said in self.commands:
            row = self.commands.index(said)
            return Reading(row, np.eye(len(self.commands), dtype=np.float32)[row])
        scores = self._scores(self._taken(said), there)
        best = int(scores.argmax())
        return Reading(best if scores[best] >= LEAST else None, scores)

    def possible(self, there: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """[C] Which commands are about nothing that is missing."""
        needs = np.where(self.things >= 0, self.things, 0)
        answer: NDArray[np.bool_] = (self.things < 0) | there[needs]
        return answer

    def nearest(self, scores: Floats, there: NDArray[np.bool_]) -> list[tuple[str, float]]:
        """The commands that a phrase is nearest to, and are possible, with their scores."""
        order = np.argsort(-np.where(self.possible(there), scores, -1.0), kind="stable")
        return [(self.commands[row], float(scores[row])) for row in order[:NEAREST]]

    def spelt(self, text: str) -> str:
        """The phrase as it is read: plain, without a full stop, slips of the finger undone."""
        said = plain(text).rstrip(".!")
        words = words_of(said)
        for word, right in zip(words, corrected(words, self._known), strict=True):
            if word != right and not self._encoder.is_word(word):
                said = re.sub(rf"\b{word}\b", right, said)
        return said

    def apart(self, said: str) -> Parts:
        """A phrase, as it is spelt, taken apart."""
        words = words_of(said)
        if not words:
            return Parts("", (), ())
        return take_apart(words, self._parts.parts(self._encoder.states(said)))

    def _taken(self, said: str) -> _Taken:
        if said not in self._seen:
            self._seen[said] = self._take(self.apart(said))
            while len(self._seen) > REMEMBERED:
                self._seen.popitem(last=False)
        return self._seen[said]

    def _take(self, parts: Parts) -> _Taken:
        texts = (parts.frame, *parts.things, *parts.places)
        frame, *rest = zip(texts, self._encoder.embed(texts), strict=True)
        return _Taken(
            self._acts.chances(*frame),
            tuple(self._names.chances(*one) for one in rest[: len(parts.things)]),
            tuple(self._places.chances(*one) for one in rest[len(parts.things) :]),
        )

    def _scores(self, taken: _Taken, there: NDArray[np.bool_]) -> Floats:
        """[C] Probability of each command; what is left is that of a refusal."""
        acts = dict(zip(ACTS, softmax(taken.acts), strict=True))
        missing = np.append(np.where(there[:THINGS], 0.0, ABSENT), 0.0).astype(np.float32)
        things = agreed([softmax(logits - missing) for logits in taken.things], THINGS)
        places = agreed([softmax(logits) for logits in taken.places], len(PLACES))
        scores = np.zeros(len(self.commands), np.float32)
        scores[:THINGS] = acts["pick"] * things
        scores[PUTS] = acts["put"] * places + [acts[place] for place in PLACES]
        scores[WAIT_ROW] = acts["wait"]
        return scores

    def with_encoder(self, encoder: Sentences) -> "Reader":
        """The same reader, which has read nothing yet, with another encoder."""
        return restore(self.tensors(), encoder)

    def tensors(self) -> Tensors:
        """All that `restore` needs, by name."""
        return {
            "reader.commands": as_bytes(list(self.commands)),
            "reader.verbs": self.verbs,
            "reader.things": self.things,
            **self._parts.tensors("reader.parts"),
            **self._acts.tensors("reader.acts"),
            **self._names.tensors("reader.names"),
            **self._places.tensors("reader.places"),
        }


def restore(tensors: Tensors, encoder: Sentences) -> Reader:
    """The reader among the tensors of a low level.

    Raises:
        PolicyError: they hold none.
    """
    try:
        return Reader(
            as_texts(tensors["reader.commands"]),
            tensors["reader.verbs"],
            tensors["reader.things"],
            tagger.restore(tensors, "reader.parts"),
            teller.restore(tensors, "reader.acts"),
            teller.restore(tensors, "reader.names"),
            teller.restore(tensors, "reader.places"),
            encoder,
        )
    except KeyError as error:
        raise PolicyError(f"these tensors hold no reader: {error} is missing") from None
    except RuntimeError as error:
        raise PolicyError(f"these tensors hold no reader: {error}") from None


def agreed(named: Sequence[Floats], count: int) -> Floats:
    """[count] What all that is named may be, each [count + 1]; nothing, if nothing is named."""
    if not named:
        return np.zeros(count, np.float32)
    least: Floats = np.min(np.stack(named), axis=0)[:count]
    return least
