"""Phrases made of a lexicon, with the part that each of their words plays.

A phrase is a row of pieces; each piece is said for one part: "filler" (courtesy, protest, where
it lies), "act", "thing", "place", or "contrast" (a thing that is not meant).
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from services.learner.pretrain.frames import Piece, cut, fill
from services.learner.pretrain.lexicon import Lexicon, Table
from shared.policies.reader.phrase import ACT, CONTRAST, FILLER, PLACE, THING, words_of
from shared.workcell.objects import index
from shared.workcell.skills import PUT_DOWN, PUT_IN_BIN, PUT_IN_TUB, PUT_ON_PLATE, WAIT, pick

_PUT = {"plate": PUT_ON_PLATE, "bin": PUT_IN_BIN, "tub": PUT_IN_TUB, "down": PUT_DOWN}
NAMED = {act: f"named_{act}" for act in ("put", *_PUT)}
"""By act the list of what is said for it when what is held is named."""
DETERMINERS = ("the", "the", "the", "that", "this", "a", "my", "")
PREPOSITIONS = ("in", "into", "on", "onto", "to")
COMMON = ("the", "a", "of", "with", "blue", "white", "small", "little", "round", "plate")
"""Words of a thing's name that can well be a place's."""
POINTING = ("it", "it", "that", "this")
BESIDE = 0.15
"""How often it is said where a thing lies."""
DIRECT = {"plate": 0.3, "bin": 0.3, "tub": 0.3, "down": 0.7}
"""How often a put is said without a place."""
BARE = 0.15
"""How often a thing is just named, half of the time without "the"; and how often a place is."""
FIRST = 0.2
"""How often the thing is named before what is to be done with it, and how often the place is."""
REMARKED = 0.4
"""How often it is then named in a remark: "you dropped {}, grab it"."""
AWAY = 0.3
"""How often what is held shall be taken from a place."""
FIXTURES = 0.15
"""How often plate, bin or tub shall be picked up."""
LOOKS = 0.3
"""How often it is said how an unknown thing looks."""
WHERE = " @ "
"""Between a thing and where it lies, until the phrase is put together."""


class Said(NamedTuple):
    """A phrase.

    parts: of each of its words the part it plays, as `shared.policies.reader.phrase` numbers them.
    act: what its frame asks for, one of `meant.ACTS`; "put" where the place tells the rest.
    meant: the command, "" for none that any robot here knows.
    """

    text: str
    parts: tuple[int, ...]
    act: str
    meant: str


class Speaker:
    """Draws phrases: acts of one lexicon, things and places of another, courtesy of a third.

    canonical: how often a thing or a place is called by a word of its first group.
    """

    def __init__(
        self,
        acts: Lexicon,
        things: Lexicon,
        courtesy: Lexicon,
        rng: np.random.Generator,
        canonical: float = 0.0,
    ) -> None:
        self._canonical = canonical
        self._acts, self._things, self._courtesy, self._rng = acts, things, courtesy, rng
        texts = (text for groups in things.things.values() for group in groups for text in group)
        self._called = {word for text in texts for word in words_of(text)} - set(COMMON)

    def pick(self, thing: str, framed: bool = False) -> Said:
        """A request to pick a thing up. framed: a verb is said, not just its name."""
        if not framed and self._rng.random() < BARE:
            return self._said([(self._just(thing), THING)], "pick", pick(index(thing)))
        return self._said(self._framed("pick", self.named(thing)), "pick", pick(index(thing)))

    def contrasted(self, thing: str, other: str) -> Said:
        """A request for one thing and not for another."""
        frame = self._any(self._courtesy.courtesy, "contrast")
        pieces: list[Piece] = []
        for part, text in cut(frame, ("{x}", "{n}")):
            if part == "{x}":
                pieces.append((self.named(other), CONTRAST))
            elif part == "{n}":
                pieces += self._bare_or_framed(self.named(thing), first=not pieces)
            else:
                pieces.append((text, FILLER))
        return self._said(pieces, "pick", pick(index(thing)))

    def contrasted_put(self, verb: str, other: str) -> Said:
        """A request to put what is held in one place and not in another."""
        frame = self._any(self._courtesy.courtesy, "places")
        places = {"{x}": (self._place(other), CONTRAST), "{n}": (self._place(verb), PLACE)}
        pieces = [places.get(part, (text, FILLER)) for part, text in cut(frame, ("{x}", "{n}"))]
        return self._said(pieces, "put", _PUT[verb])

    def bare_put(self, verb: str) -> Said:
        """Nothing but where what is held shall go."""
        return self._said([(self._place(verb), PLACE)], "put", _PUT[verb])

    def put(self, verb: str, named: str = "", placed: bool = False) -> Said:
        """A request to put what is held on the plate, in the bin, in the tub or on the table.

        named: a thing that is named as what is held. placed: the place is said, whatever the verb.
        """
        held = self.named(named) if named else ""
        direct = NAMED.get(verb, "") if named else verb
        if self._acts.acts.get(direct) and not placed and self._rng.random() < DIRECT[verb]:
            frame = self._any(self._acts.acts, direct)
            return self._said(fill(frame, held, ""), verb, _PUT[verb])
        place = self._name(self._things.places, verb)
        frame = self._turned(self._any(self._acts.acts, NAMED["put"] if named else "put"), "[]")
        return self._said(fill(frame, held, place), "put", _PUT[verb])

    def wait(self) -> Said:
        """A request to wait."""
        return self._said([(self._any(self._acts.acts, "wait"), ACT)], "wait", WAIT)

    def unknown_thing(self) -> Said:
        """A request to pick up what no robot here knows."""
        return self._said(self._framed("pick", self._unknown()), "pick", "")

    def unknown_held(self) -> Said:
        """A request to put somewhere what no robot here can hold."""
        place = self._name(self._things.places, str(self._rng.choice(list(_PUT))))
        frame = self._any(self._acts.acts, NAMED["put"])
        return self._said(fill(frame, self._unknown(), place), "put", "")

    def _unknown(self) -> str:
        if self._rng.random() < FIXTURES:
            return str(self._rng.choice(nouns(self._things.places)))
        noun = self._any(self._things.others, "things")
        look = self._any(self._things.others, "looks") if self._rng.random() < LOOKS else ""
        return self._determined(f"{look} {noun}".strip())

    def unknown_act(self, thing: str) -> Said:
        """A request to do with a thing what no robot here can do."""
        frame = self._any(self._acts.others, "acts")
        return self._said(fill(frame, self.named(thing), ""), "refuse", "")

    def unknown_place(self, named: str = "") -> Said:
        """A request to put what is held somewhere else."""
        place = self._any(self._things.places, "other")
        frame = self._any(self._acts.acts, NAMED["put"] if named else "put")
        return self._said(fill(frame, self.named(named) if named else "", place), "put", "")

    def beside_place(self, named: str = "") -> Said:
        """A request to put what is held next to or under plate, bin or tub, or to take it away."""
        noun = str(self._rng.choice(nouns(self._things.places)))
        away = not named and self._rng.random() < AWAY
        place = self._any(self._things.others, "removals" if away else "relations").format(noun)
        frame = self._any(self._acts.acts, NAMED["put"] if named else "put")
        return self._said(fill(frame, self.named(named) if named else "", place), "put", "")

    def pointing(self) -> Said:
        """A request to pick up what isn't named."""
        frame = self._any(self._acts.acts, "pick").replace("{}", str(self._rng.choice(POINTING)))
        return self._said([(frame, ACT)], "pick", "")

    def chat(self) -> Said:
        """Whatever else is said."""
        return self._said([(self._any(self._acts.others, "said"), ACT)], "refuse", "")

    def two(self, thing: str, other: str) -> Said:
        """A request for two things at once."""
        texts = [self.named(thing), self.named(other)]
        pieces = []
        for part, text in cut(self._any(self._courtesy.courtesy, "two"), ("{}",)):
            pieces.append((texts.pop(0), THING) if part else (text, ACT))
        return self._said(pieces, "refuse", "")

    def dressed(self, said: Said) -> Said:
        """The same with courtesy or protest before, after, or both; maybe where the thing lies."""
        where = int(self._rng.integers(3))
        before = self._any(self._courtesy.courtesy, "before") if where != 1 else ""
        after = self._any(self._courtesy.courtesy, "after") if where != 0 else ""
        glue = "" if after.startswith(",") else " "
        text = f"{before} {said.text}{glue}{after}".strip()
        parts = (
            *([FILLER] * len(words_of(before))),
            *said.parts,
            *([FILLER] * len(words_of(after))),
        )
        return said._replace(text=text, parts=parts)

    def misspelt(self, said: Said) -> Said:
        """The same with a slip of the finger in one long word."""
        words = words_of(said.text)
        long = [word for word in words if len(word) > 3 and word.isalpha()]
        if not long:
            return said
        word = str(self._rng.choice(long))
        at = 1 + int(self._rng.integers(len(word) - 2))
        slip = int(self._rng.integers(3))
        if slip == 0:
            wrong = word[:at] + word[at + 1] + word[at] + word[at + 2 :]
        else:
            wrong = word[:at] + (word[at] * 2 if slip == 1 else "") + word[at + 1 :]
        return said._replace(text=said.text.replace(word, wrong, 1))

    def named(self, thing: str) -> str:
        """A thing with its determiner, by any of its names."""
        noun = self._determined(self._name(self._things.things, thing))
        if self._rng.random() < BESIDE:
            noun += WHERE + self._any(self._courtesy.courtesy, "beside")
        return noun

    def _just(self, thing: str) -> str:
        noun = self._name(self._things.things, thing)
        return noun if self._rng.random() < 0.5 else f"the {noun}"

    def _place(self, verb: str) -> str:
        """A place, half of the time without its preposition, unless a thing is called so."""
        place = self._name(self._things.places, verb)
        first, _, rest = place.partition(" ")
        bare = first in PREPOSITIONS and rest.startswith(("the ", "my "))
        bare = bare and self._called.isdisjoint(words_of(rest))
        return rest if bare and self._rng.random() < 0.5 else place

    def _determined(self, noun: str) -> str:
        return f"{self._rng.choice(DETERMINERS)} {noun}".strip()

    def _framed(self, verb: str, noun: str) -> list[Piece]:
        frame = self._turned(self._any(self._acts.acts, verb), "{}")
        remarks = self._courtesy.courtesy.get("about", ())
        if not remarks or not frame.startswith("{}, ") or self._rng.random() >= REMARKED:
            return fill(frame, noun, "")
        remark = cut(self._any(self._courtesy.courtesy, "about"), ("{}",))
        told = [(noun, THING) if slot else (text, FILLER) for slot, text in remark]
        return [*told, (frame.removeprefix("{}"), ACT)]

    def _turned(self, frame: str, slot: str) -> str:
        """Now and then with the slot first: "grab {}" as "{}, grab it"."""
        if frame.startswith(("{}", "[]")) or self._rng.random() >= FIRST:
            return frame
        return f"{slot}, {frame.replace(slot, 'it' if slot == '{}' else '').strip()}"

    def _bare_or_framed(self, noun: str, first: bool) -> list[Piece]:
        if not first and self._rng.random() < 0.5:
            return [(noun, THING)]
        return self._framed("pick", noun) if first else [(noun, THING)]

    def _name(self, table: Table, name: str) -> str:
        if self._rng.random() < self._canonical:
            return str(self._rng.choice(table[name][0]))
        return self._any(table, name)

    def _any(self, table: Table, name: str) -> str:
        groups = table[name]
        return str(self._rng.choice(groups[int(self._rng.integers(len(groups)))]))

    def _said(self, pieces: Sequence[Piece], act: str, meant: str) -> Said:
        pieces = [split for piece in pieces for split in _parted(piece)]
        text = " ".join(" ".join(piece for piece, _ in pieces).split()).replace(" ,", ",")
        parts = tuple(part for piece, part in pieces for _ in words_of(piece))
        return Said(text, parts, act, meant)


def nouns(places: Table) -> list[str]:
    """What plate, bin and tub are called, without a preposition."""
    names = [
        text.partition(" ")
        for verb in ("plate", "bin", "tub")
        for group in places[verb]
        for text in group
    ]
    return [noun for first, _, noun in names if first in PREPOSITIONS and noun.startswith("the ")]


def _parted(piece: Piece) -> list[Piece]:
    """A thing and where it lies."""
    thing, _, where = piece[0].partition(WHERE)
    return [(thing, piece[1]), *([(where, FILLER)] if where else [])]
