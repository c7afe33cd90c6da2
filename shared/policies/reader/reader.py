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
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from shared.errors import PolicyError
from shared.goals.family import Floats
from shared.policies.checkpoint import Tensors
from shared.policies.examples import as_bytes, as_texts
from shared.policies.reader import tagger, teller
from shared.policies.reader.claims import put_on
from shared.policies.reader.clauses import EXCLUDES, judged
from shared.policies.reader.located import arm_of, located
from shared.policies.reader.looks import KINDS, as_things, fitting
from shared.policies.reader.meant import (
    LEAST_ACT,
    PUTS,
    THINGS,
    WAIT_ROW,
    Reading,
    Taken,
    excluded,
)
from shared.policies.reader.phrase import (
    THING,
    Parts,
    plain,
    related,
    take_apart,
    words_of,
)
from shared.policies.reader.remarks import set_apart
from shared.policies.reader.spelling import corrected
from shared.policies.reader.spoken import written
from shared.policies.reader.tagger import Tagger
from shared.policies.reader.teller import Teller, softmax
from shared.policies.reader.weighed import Scale

NEAREST = 3
FAINT = 0.01
"""A score below it orders nothing: the command means something else altogether."""
REMEMBERED = 4096


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
        self._encoder, self._scale = encoder, Scale(self.commands, names.alike.owner)
        self._sentences = encoder.embed(self.commands)  # Now: later robots are moving.
        self._rows = {bare(text): row for row, text in enumerate(commands)}
        self._known = {
            word
            for known in (acts, names, places)
            for text in known.alike.texts
            for word in words_of(text)
        }
        self._lock = threading.Lock()
        self._seen: OrderedDict[str, Taken] = OrderedDict()

    def read(self, text: str, there: NDArray[np.bool_]) -> Reading:
        """The command that a phrase means, which may be about what is missing in the scene.

        there: [18] bool, what is in the scene.
        """
        said = bare(text)
        if said not in self._rows:  # A command as it is needs no encoder to be read.
            said = self.spelt(said)
        row = self._rows.get(said)
        if row is not None:
            return self._plainly(row)
        reading = self._weighed(self._taken(said), there)
        if reading.command is None and not reading.why:
            return self._besides(said, there) or reading
        return reading

    def _plainly(self, row: int) -> Reading:
        return Reading(row, np.eye(len(self.commands), dtype=np.float32)[row])

    def _weighed(self, taken: Taken, there: NDArray[np.bool_]) -> Reading:
        if taken.parts.holds:
            return self._plainly(WAIT_ROW)
        return self._scale(taken, there, self.possible(there))

    def _besides(self, said: str, there: NDArray[np.bool_]) -> Reading | None:
        """A phrase without its remarks, None where nothing of that can be obeyed; where it points
        at something, a thing that the remarks name is meant."""
        orders, remarks = set_apart(said)
        if not remarks or not words_of(orders):
            return None
        taken = self._taken(orders)
        if not taken.parts.things and not taken.parts.places:
            named = {row: thing for remark in remarks for row, thing in self._named(remark)}
            things = tuple(named.values()) if len(named) == 1 else ()
            taken = self._take(taken.parts._replace(things=things))
        reading = self._weighed(taken, there)
        return reading if reading.command is not None else None

    def _named(self, remark: str) -> list[tuple[int, str]]:
        """The things that a remark surely names, each with its row."""
        taken = self._taken(remark)
        told = [softmax(logits)[:THINGS] for logits in taken.things]
        pairs = zip(taken.parts.things, told, strict=True)
        return [(int(p.argmax()), name) for name, p in pairs if p.max() >= LEAST_ACT]

    def possible(self, there: NDArray[np.bool_], empty: bool = False) -> NDArray[np.bool_]:
        """[C] Which commands are about nothing that is missing; empty: nothing is in the hands."""
        needs = np.where(self.things >= 0, self.things, 0)
        answer: NDArray[np.bool_] = (self.things < 0) | there[needs]
        if empty:
            answer[PUTS] = False
        return answer

    def nearest(
        self,
        text: str,
        there: NDArray[np.bool_],
        empty: bool = False,
        reading: Reading | None = None,
    ) -> list[tuple[str, float]]:
        """The possible commands that a phrase is nearest to, with their scores; see `possible`.
        Those that are faint in what is like nothing known come by likeness of the sentences.

        reading: what it was read as, where more is known of the scene than what is there.
        """
        reading = reading or self.read(text, there)
        scores, can = reading.scores, self.possible(there, empty)
        if reading.command is not None and not can[reading.command]:
            acts, names, _ = self._taken(self.spelt(text)).told(there, len(self.commands))
            scores = acts * names  # Also of a command as it is: of the others it tells nothing.
        first, alike = scores, np.zeros(len(scores))
        if reading.command is None and not reading.why:
            first = np.where(scores < FAINT, 0.0, scores)
            alike = self._sentences @ self._encoder.embed([bare(text)])[0]
        order = np.lexsort((-alike, -np.where(can, first, -1.0)))
        return [(self.commands[row], float(scores[row])) for row in order[:NEAREST] if can[row]]

    def spelt(self, text: str) -> str:
        """The phrase as it is read: plain, in standard words, without a full stop, slips undone."""
        said = written(bare(text))
        words = words_of(said)
        for word, right in zip(words, corrected(words, self._known), strict=True):
            if word != right and not self._encoder.is_word(word):
                said = re.sub(rf"\b{word}\b", right, said)
        return said

    def apart(self, said: str) -> Parts:
        """A phrase, as it is spelt, taken apart."""
        found = located(said)
        words = words_of(found.said)
        if not words:
            return Parts("", (), ())
        parts = related(words, self._parts.parts(self._encoder.states(found.said)))
        parts = [THING if row in found.rows else part for row, part in enumerate(parts)]
        told = judged(found.said, as_things(words, parts))
        return take_apart(words, told.parts)._replace(
            why=found.why or told.why,
            first=told.first,
            idle=told.idle,
            holds=told.holds,
            side=found.side,
            two=found.two,
            arm=arm_of(said),
            ranked=found.ranked,
            onto=put_on(found.said),
        )

    def _taken(self, said: str) -> Taken:
        with self._lock:
            known = self._seen.get(said)
        if known is None:
            known = self._take(self.apart(said))
            with self._lock:
                self._seen[said] = known
                while len(self._seen) > REMEMBERED:
                    self._seen.popitem(last=False)
        return known

    def _take(self, parts: Parts) -> Taken:
        vectors = dict(zip(parts.texts(), self._encoder.embed(parts.texts()), strict=True))
        things = {
            text: self._names.chances(text, vectors[text])
            for text in (*parts.things, *parts.others())
        }
        if any(excluded(text, things) for text in parts.things):
            parts = parts._replace(why=parts.why or EXCLUDES)
        return Taken(
            self._acts.chances(parts.frame, vectors[parts.frame]),
            tuple(things[text] for text in parts.things),
            tuple(self._places.chances(text, vectors[text]) for text in parts.places),
            parts,
            tuple(filter(np.any, (self._known_as(text, vectors[text]) for text in parts.onto))),
        )

    def _known_as(self, text: str, vector: Floats) -> NDArray[np.bool_]:
        """[15] Which things a name surely is of."""
        fits = fitting(text)
        if fits is not None:
            return fits if not KINDS.issuperset(words_of(text)) else np.zeros(THINGS, np.bool_)
        told: NDArray[np.bool_] = softmax(self._names.chances(text, vector))[:THINGS] >= LEAST_ACT
        return told

    def with_encoder(self, encoder: Sentences) -> "Reader":
        """The same reader, which has read nothing yet, with another encoder."""
        return restore(self.tensors(), encoder)

    @property
    def tagger(self) -> Tagger:
        """What tells the part of each word."""
        return self._parts

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
