"""Reads a person's phrase as one of the commands that the low level knows, or refuses it.

The phrase is taken apart by the states of its words: courtesy is dropped; the frame, with a word
that stands for each thing and place, tells what to do; and thing and place are told by the known
names that they are most like. What lies in the scene narrows the choice; what is like nothing
known, or most like what nobody here can do, is refused.
"""

import re
import threading
from collections import OrderedDict
from collections.abc import Iterable, Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from shared.errors import PolicyError
from shared.goals.family import Floats
from shared.policies import tagger, teller
from shared.policies.checkpoint import Tensors
from shared.policies.clauses import AGAINST, EXCLUDES, judged
from shared.policies.examples import as_bytes, as_texts
from shared.policies.phrase import Parts, plain, related, take_apart, unlike, words_of
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
LEAST_ACT = 0.5
LEAST_NAME = 0.3
"""What is to be done, or the thing or place that is named, is refused where it is less probable."""


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
    command its probability. things: of each thing that it names how probable each of the [15] is.
    why: what is wrong with a phrase, if it is more than that it wasn't understood.
    first: what it says to do before.
    """

    command: int | None
    scores: Floats
    things: tuple[Floats, ...] = ()
    why: str = ""
    first: str = ""


class _Taken(NamedTuple):
    """A phrase as understood without its scene: logits of acts [8], of each thing [15 + 1] and
    each place [4 + 1] that it names. parts: of what."""

    acts: Floats
    things: tuple[Floats, ...]
    places: tuple[Floats, ...]
    parts: Parts


class Reader:
    """Knows twenty commands. Pure, and safe to use from several threads; remembers.

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
        self._rows = {bare(text): row for row, text in enumerate(commands)}
        self._known = {
            word
            for known in (acts, names, places)
            for text in known.alike.texts
            for word in words_of(text)
        }
        self._lock = threading.Lock()
        self._seen: OrderedDict[str, _Taken] = OrderedDict()

    def read(self, text: str, there: NDArray[np.bool_]) -> Reading:
        """The command that a phrase means, which may be about what is missing in the scene.

        there: [18] bool, what is in the scene.
        """
        said = bare(text)
        if said not in self._rows:  # A command as it is needs no encoder to be read.
            said = self.spelt(said)
        row = self._rows.get(said)
        if row is not None:
            return Reading(row, np.eye(len(self.commands), dtype=np.float32)[row])
        taken = self._taken(said)
        acts, names, things = self._told(taken, there)
        scores = acts * names
        best = int(scores.argmax())
        sure = acts[best] >= LEAST_ACT and names[best] >= LEAST_NAME
        why = taken.parts.why or self._fixed(best if sure else None, taken.parts.things, there)
        if why in AGAINST:
            scores[best] = 0.0
        return Reading(best if sure and not why else None, scores, things, why, taken.parts.first)

    def possible(self, there: NDArray[np.bool_], empty: bool = False) -> NDArray[np.bool_]:
        """[C] Which commands are about nothing that is missing; empty: nothing is in the hands."""
        needs = np.where(self.things >= 0, self.things, 0)
        answer: NDArray[np.bool_] = (self.things < 0) | there[needs]
        if empty:
            answer[PUTS] = False
        return answer

    def nearest(
        self, text: str, there: NDArray[np.bool_], empty: bool = False
    ) -> list[tuple[str, float]]:
        """The possible commands that a phrase is nearest to, with their scores; see `possible`."""
        reading = self.read(text, there)
        scores, can = reading.scores, self.possible(there, empty)
        if reading.command is not None and not can[reading.command]:
            acts, names, _ = self._told(self._taken(self.spelt(text)), there)
            scores = acts * names  # Also of a command as it is: of the others it tells nothing.
        order = np.argsort(-np.where(can, scores, -1.0), kind="stable")
        return [(self.commands[row], float(scores[row])) for row in order[:NEAREST] if can[row]]

    def spelt(self, text: str) -> str:
        """The phrase as it is read: plain, without a full stop, slips of the finger undone."""
        said = bare(text)
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
        told = judged(said, related(words, self._parts.parts(self._encoder.states(said))))
        return take_apart(words, told.parts)._replace(why=told.why, first=told.first)

    def _taken(self, said: str) -> _Taken:
        with self._lock:
            known = self._seen.get(said)
        if known is None:
            known = self._take(self.apart(said))
            with self._lock:
                self._seen[said] = known
                while len(self._seen) > REMEMBERED:
                    self._seen.popitem(last=False)
        return known

    def _take(self, parts: Parts) -> _Taken:
        vectors = dict(zip(parts.texts(), self._encoder.embed(parts.texts()), strict=True))
        things = {
            text: self._names.chances(text, vectors[text])
            for text in (*parts.things, *parts.others())
        }
        for text in parts.things:  # "One that isn't ham" is like the ham.
            other = softmax(things[unlike(text)])[:THINGS] if unlike(text) else np.zeros(THINGS)
            if other[things[text].argmax() % THINGS] >= LEAST_ACT:
                parts = parts._replace(why=parts.why or EXCLUDES)
        return _Taken(
            self._acts.chances(parts.frame, vectors[parts.frame]),
            tuple(things[text] for text in parts.things),
            tuple(self._places.chances(text, vectors[text]) for text in parts.places),
            parts,
        )

    def _fixed(self, row: int | None, things: Sequence[str], there: NDArray[np.bool_]) -> str:
        """Why a place that is named for a thing can't be taken, "" where something else is meant.

        row: the command that was read.
        """
        if row is not None and (row >= THINGS or self.possible(there)[row]):
            return ""
        here = [name for at, name in enumerate(PLACES[:-1], THINGS) if there[at]]
        named = next((name for name in here if name in things), "")
        return f"can't be done: nobody here can take the {named}" if named else ""

    def _told(
        self, taken: _Taken, there: NDArray[np.bool_]
    ) -> tuple[Floats, Floats, tuple[Floats, ...]]:
        """[C] each: how probable each command's act is, and then its thing or place; and of each
        thing that is named how probable each of the [15] is."""
        told = dict(zip(ACTS, softmax(taken.acts), strict=True))
        missing = np.append(np.where(there[:THINGS], 0.0, ABSENT), 0.0).astype(np.float32)
        things = tuple(softmax(logits - missing)[:THINGS] for logits in taken.things)
        acts, names = np.ones((2, len(self.commands)), np.float32)
        acts[:THINGS] = told["pick"]
        names[:THINGS] = agreed(things, THINGS)
        places = agreed([softmax(logits)[: len(PLACES)] for logits in taken.places], len(PLACES))
        put, without_place = told["put"], np.array([told[place] for place in PLACES])
        if taken.places:  # To let go of something in a place is to put it there.
            put, without_place[-1] = put + told["down"], 0.0
        acts[PUTS] = put + without_place
        known = min((float(thing.sum()) for thing in things), default=1.0)
        names[PUTS] = known * (put * places + without_place) / acts[PUTS]
        acts[WAIT_ROW] = told["wait"]
        return acts, names, things

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


def bare(text: str) -> str:
    """A text in lower case, single spaces, without a full stop."""
    return plain(text).rstrip(".!")


def agreed(named: Sequence[Floats], count: int) -> Floats:
    """[count] What all that is named may be, each [count]; nothing, if nothing is named."""
    if not named:
        return np.zeros(count, np.float32)
    least: Floats = np.min(np.stack(named), axis=0)
    return least
