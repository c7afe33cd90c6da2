"""Whether a clause asks for anything: what only forbids, complains or tells is not to be obeyed.

What a clause is about can't tell that: "you picked up the ham" names an act and a thing. So a mark
of denial, dislike or of what was makes a clause one that asks for nothing, unless it describes a
thing ("the slice that isn't toasted"), an order stands before it ("take the cup, not the glass"),
or an order follows what is told ("the cup fell over pick it up").
"""

import re
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from shared.policies.reader.marks import (
    ACTED,
    ADVERB,
    ASKING,
    AWAY,
    DENIES,
    DOES,
    ENDS,
    KEEPS,
    LEADING,
    LETS_GO,
    NAMING,
    NO_USE,
    ORDERS,
    RELATIVE,
    STATES,
    TELLING,
    UNCHANGED,
    VERBAL,
)
from shared.policies.reader.phrase import ACT, CONTRAST, DETERMINERS, FILLER, THING
from shared.policies.reader.remarks import INTERJECTIONS
from shared.policies.reader.verbs import PICK, PUT, WAIT, verb_of
from shared.policies.reader.wording import Words

TELLS = "forbids something, or tells how things are or were, and asks for nothing: say what to do"
_ONE = frozenset(("one", "ones", "thing", "object"))


class Mark(NamedTuple):
    """Words by which a clause asks for nothing. row: of the first. end: after the last.
    denies: what follows it. ends: what follows it up to "and".
    """

    row: int
    end: int
    denies: bool = False
    ends: bool = False


def is_idle(phrase: Words, clauses: Sequence[range]) -> bool:
    """Whether some clause asks for nothing, and no other asks for something."""
    silent = [rows for rows in clauses if asks_nothing(phrase, rows)]
    others = [rows for rows in clauses if rows not in silent]
    return bool(silent) and not any(
        phrase.tells(rows) or _orders(phrase, rows, asked=True) for rows in others
    )


def only_holds(phrase: Words) -> bool:
    """Whether it says to go on holding what is held, and nothing else."""
    text = " ".join(phrase.words)
    if not KEEPS.search(text):
        return False
    told = re.sub(KEEPS, _blank, re.sub(LETS_GO, _blank, text)).split()
    return not phrase.tells(row for row, word in enumerate(told) if word != "_")


def _blank(found: re.Match[str]) -> str:
    return re.sub(r"\S+", "_", found.group())


def asks_nothing(phrase: Words, rows: range) -> bool:
    """Whether a clause is nothing to obey."""
    return any(not _excused(phrase, rows, mark) for mark in _marks(phrase, rows))


def tells_state(phrase: Words, rows: range) -> bool:
    """Whether a clause says how something is, and asks for nothing: "the bin is full"."""
    found = _state(phrase, rows)
    end = _subject(phrase, rows) + len(found.group().split()) if found else rows.stop
    return found is not None and not _orders(phrase, range(end, rows.stop), asked=True)


def _subject(phrase: Words, rows: range) -> int:
    """Where a clause begins, after what only calls; "there is" calls nobody."""
    begin = next((row for row in rows if phrase.words[row] not in INTERJECTIONS), rows.start)
    is_there = phrase.words[begin - 1 : begin + 1] in (["there", "is"], ["there", "are"])
    return begin - 1 if begin > rows.start and is_there else begin


def _state(phrase: Words, rows: range) -> re.Match[str] | None:
    begin = _subject(phrase, rows)
    return STATES.match(" ".join(phrase.words[row] for row in range(begin, rows.stop)))


def _marks(phrase: Words, rows: range) -> Iterable[Mark]:
    text = " ".join(phrase.words[row] for row in rows)
    text = ORDERS.sub(_blank, text)
    for pattern in (DENIES, ENDS, TELLING):
        for found in pattern.finditer(text):
            begin, end = (rows.start + text[:at].count(" ") for at in found.span())
            yield Mark(begin, end + 1, pattern is DENIES, pattern is ENDS)
    told = _subject(phrase, rows)
    if state := _state(phrase, rows):
        yield Mark(told, told + len(state.group().split()))
    for found in DOES.finditer(text):
        subject = rows.start + text[: found.start()].count(" ")
        row = rows.start + text[: found.end()].count(" ") + 1
        asked = phrase.words[max(subject - 1, rows.start)] in ASKING | NAMING
        begins = subject == told and phrase.words[subject - 1] not in ("now", "please")
        long = row - subject > 1 or (begins and _has_object(phrase.words, row))
        if not asked and _is_done(phrase.words, row, long):
            yield Mark(subject, row + 1)
    for row in rows:
        if phrase.words[row] == "no" and _none_of(phrase, rows, row):
            yield Mark(row, row + 1, denies=True)


def _is_done(words: list[str], row: int, long: bool) -> bool:
    """Whether the verb there tells what is or was done. long: more stands before it than a
    subject, so that "put" is of the past."""
    word = words[row]
    acts = bool(verb_of(words, row)) and word.endswith(("ed", "ing"))
    does = words[row - 1] in ("he", "she", "it", "somebody", "someone") and word.endswith("s")
    return (
        bool(acts or (does and verb_of(words, row)))
        or word in ACTED
        or (long and word in UNCHANGED)
    )


def _has_object(words: list[str], row: int) -> bool:
    """Whether something follows that is acted on: "you put it there"."""
    return words[row + 1 : row + 2] != [] and words[row + 1] in DETERMINERS | {"it", "them"}


def _none_of(phrase: Words, rows: range, row: int) -> bool:
    """Whether "no" belongs to what follows: "no ham", "no need", and not "no, the ham"."""
    if row + 1 >= rows.stop or phrase.words[row + 1] in DETERMINERS:
        return False
    return phrase.words[row + 1] in NO_USE or phrase.parts[row + 1] in (THING, CONTRAST)


def _excused(phrase: Words, rows: range, mark: Mark) -> bool:
    """Whether a mark tells nothing of the clause."""
    before, after = range(rows.start, mark.row), range(mark.end, rows.stop)
    if _describes(phrase, before, mark.row) or _orders(phrase, before, asked=True):
        return True
    if not mark.denies:
        begins = [row + 1 for row in after if mark.ends and phrase.words[row] == "and"]
        rests = (range(begin, rows.stop) for begin in (mark.end, *begins))
        return any(_orders(phrase, rest, asked=False) for rest in rests)
    acts = phrase.acts(after)
    if len(acts) > 1 and _orders(phrase, range(acts[0] + 2, rows.stop), asked=False):
        return True  # "Don't put it on the plate put it down".
    bare = phrase.words[mark.row] in ("not", "no", "nothing", "without")
    verbal = bool(before) and phrase.words[before[-1]] in VERBAL
    others = [row for row in after if phrase.parts[row] != CONTRAST]
    contrasts = phrase.words[mark.row] == "not" and len(others) < len(after)
    return bare and not verbal and (phrase.tells(before) or (contrasts and phrase.tells(others)))


def _describes(phrase: Words, before: range, row: int) -> bool:
    """Whether it says which thing is meant: "the slice that isn't toasted"."""
    relatives = [at for at in (*before, row) if phrase.words[at] in RELATIVE]
    return any(
        at > before.start and (phrase.parts[at - 1] == THING or phrase.words[at - 1] in _ONE)
        for at in relatives
    )


def _orders(phrase: Words, rows: range, asked: bool) -> bool:
    """Whether there is an order among these words. asked: "can you take" is one."""
    for row in rows:
        if not _is_act(phrase, row):
            continue
        before = row - 1
        while before >= rows.start and ADVERB.fullmatch(phrase.words[before]):
            before -= 1
        requested = asked and ASKING.intersection(phrase.words[max(row - 3, 0) : row])
        if before < rows.start or phrase.words[before] not in LEADING or requested:
            return True
    return False


def _is_act(phrase: Words, row: int) -> bool:
    """Whether a verb stands there that may be an order, be it one that nobody listed: "nip it"."""
    word, after = phrase.words[row], phrase.words[row + 1 : row + 2]
    if word.endswith(("ed", "ing")):
        return False
    begins = row in phrase.begins or not row
    unlisted = after[:1] in (["it"], ["that"], ["them"]) or (word in AWAY and bool(after))
    unlisted = unlisted and begins and phrase.parts[row] == ACT
    return phrase.verb(row, (ACT, FILLER)) in (PICK, PUT, WAIT) or unlisted
