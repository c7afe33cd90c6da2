"""Grammar: what people say for the commands that a robot knows, and which command they mean.

Pure: commands in, a JSGF grammar and a table of sentences out. "stop" is in no sentence: stopping
has a key of its own, and the word cost errors where it stood before others.
"""

import difflib
import re
from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from itertools import product

Slots = tuple[tuple[str, ...], ...]
"""A sentence, place by place; each place takes one of its words, "" stands for none."""

MAX_COMMANDS = 300
ALIKE = 0.72
APART = 0.03
NO_WORD = re.compile(r"[^a-z' ]+")

BEFORE: Slots = (("", "no"), ("", "please", "robot"), ("", "please"))
AFTER: Slots = (("", "first", "instead", "now", "please"),)
COURTESY = frozenset(word for slot in (*BEFORE, *AFTER) for word in slot if word)

PICK = ("", "pick up", "take", "grab", "get", "lift")
PUT = ("put", "place", "drop")
PLACES = {"on": ("on", "onto"), "in": ("in", "into")}
NAMES = {
    "bin": ("bin", "trash", "rubbish", "garbage"),
}
"""Other names of things and places that nothing else on the table has."""
PHRASES: dict[str, tuple[Slots, ...]] = {
    "wait": ((("wait", "hold on", "wait a moment"),),),
    "put it down": (
        (("put", "set", "lay"), ("it", "that", "this"), ("down", "on the table")),
        (("put",), ("down",), ("", "it", "that", "this")),
    ),
}


class Grammar:
    """The commands of a robot as sentences.

    commands: those that can be said. silent: those that can't, since they hold a character or a
        word that no recogniser could hear.
    """

    def __init__(self, commands: Sequence[str], spelt: Callable[[str], bool] = bool) -> None:
        """spelt: whether the recogniser knows how a word sounds."""
        known = dict.fromkeys(commands)
        ways = {text: tuple(_ways(text, spelt)) for text in list(known)[:MAX_COMMANDS]}
        self._ways = {text: found for text, found in ways.items() if found}
        self.commands = tuple(self._ways)
        self.silent = tuple(text for text in known if text not in self._ways)

    @cached_property
    def sentences(self) -> dict[str, str]:
        """Every sentence without courtesies, and its command; the first command keeps one."""
        found: dict[str, str] = {}
        for command, ways in self._ways.items():
            for sentence in (_join(words) for way in ways for words in product(*way)):
                found.setdefault(sentence, command)
        return found

    @property
    def jsgf(self) -> str:
        """The grammar as the Java Speech Grammar Format writes it."""
        said = " | ".join(_rule(way) for ways in self._ways.values() for way in ways)
        return (
            "#JSGF V1.0;\ngrammar commands;\n"
            f"public <said> = {_rule(BEFORE)} <command> {_rule(AFTER)};\n<command> = {said};\n"
        )

    def exact(self, heard: str) -> str | None:
        """The command of a sentence of this grammar."""
        return self.sentences.get(bare(heard)) or self.sentences.get(plain(heard))

    def nearest(self, heard: str) -> str | None:
        """The command that freely heard words mean; None where no sentence is near enough, or
        two commands are equally near."""
        said = bare(heard)
        if exact := self.exact(heard):
            return exact
        best: dict[str, float] = {}
        match = difflib.SequenceMatcher(b=said, autojunk=False)
        for sentence, command in self.sentences.items():
            match.set_seq1(sentence)
            if match.real_quick_ratio() > ALIKE and match.quick_ratio() > ALIKE:
                best[command] = max(best.get(command, 0.0), match.ratio())
        (first, score), (_, second) = (*_ranked(best), ("", 0.0), ("", 0.0))[:2]
        return first if score >= ALIKE and score - second >= APART else None


def plain(text: str) -> str:
    """Lower-case words and single spaces."""
    return " ".join(NO_WORD.sub(" ", text.lower().replace("’", "'").replace("-", " ")).split())


def bare(text: str) -> str:
    """Without the courtesies around a command."""
    words = plain(text).split()
    while words and words[0] in COURTESY:
        words.pop(0)
    while words and words[-1] in COURTESY:
        words.pop()
    return " ".join(words)


def _ranked(scores: dict[str, float]) -> list[tuple[str, float]]:
    return sorted(scores.items(), key=lambda pair: -pair[1])


def _ways(command: str, spelt: Callable[[str], bool]) -> Iterator[Slots]:
    """How a command may be said, with words that the recogniser knows."""
    text = " ".join(command.lower().split())
    if not text or plain(text) != text or bare(text) != text:
        return
    for way in _synonyms(text) or (((text,),),):
        heard = tuple(tuple(words for words in slot if _all_spelt(words, spelt)) for slot in way)
        if all(heard):
            yield heard


def _all_spelt(words: str, spelt: Callable[[str], bool]) -> bool:
    return all(spelt(word) for word in words.split())


def _synonyms(text: str) -> tuple[Slots, ...]:
    if text in PHRASES:
        return PHRASES[text]
    if thing := re.fullmatch(r"pick up the (.+)", text):
        return ((PICK, ("the",), _names(thing[1])),)
    if place := re.fullmatch(r"put it (on|in) the (.+)", text):
        where: Slots = (PLACES[place[1]], ("the",), _names(place[2]))
        return ((PUT, ("it", "that", "this"), *where), where)
    return ()


def _names(thing: str) -> tuple[str, ...]:
    return NAMES.get(thing, (thing,))


def _rule(slots: Slots) -> str:
    return " ".join(_place(slot) for slot in slots)


def _place(slot: tuple[str, ...]) -> str:
    words = " | ".join(word for word in slot if word)
    return f"[{words}]" if "" in slot else f"({words})"


def _join(words: Sequence[str]) -> str:
    return " ".join(word for word in words if word)
