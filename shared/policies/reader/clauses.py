"""What a phrase forbids, asks or only leaves out, and what of it is left to obey.

The tellers know what a clause is about, and not whether it is wished: "don't put it down" is about
putting down. So clauses are judged by their words before, each word with the part that it plays:
what is not wished becomes courtesy where something else is said, and a reason to refuse where not.
"""

import itertools
import re
from collections.abc import Sequence
from typing import NamedTuple

from shared.goals.language.encoder import WORD
from shared.policies.reader.asking import TELLS, is_idle, only_holds, tells_state
from shared.policies.reader.claims import WAS, was_there
from shared.policies.reader.later import put_off
from shared.policies.reader.located import SIDE
from shared.policies.reader.patterns import ALONE, BESIDE, MANY, OFF, SIDES
from shared.policies.reader.phrase import (
    ACT,
    CONTRAST,
    FILLER,
    PARTS,
    PLACE,
    THING,
    words_of,
)
from shared.policies.reader.questions import SUBJECTS, asks
from shared.policies.reader.verbs import MOVE, PICK, PUT, WAIT
from shared.policies.reader.wording import Words

FORBIDS = "forbids something, and a prohibition can't be obeyed: say what to do instead"
ASKS = "is a question: say what is to be done"
EXCLUDES = "says what is not meant: name the thing or the place that is"
NEARBY = "is about a spot beside a place, and things are put on or in it: say 'on the plate'"
REMOVES = "takes something off a place: say 'pick up', and its name"
SEVERAL = "asks for several things: one thing at a time, by its name"
AGAINST = frozenset((FORBIDS, EXCLUDES, TELLS))
"""What is read of these is what is not wished."""

_BREAK = re.compile(r"[,.;:!?]")
_NEVER = frozenset(
    words_of("not never cannot dont doesnt didnt shouldnt mustnt cant wont isnt arent")
)
_ORDERS = frozenset(("don't", "dont", "never", "not"))
"""They forbid even where they are told as courtesy, unless a subject is before: "don't bin it"."""
_ENDING = frozenset(("stop", "quit", "avoid", "cease"))
"""Before a verb in -ing they forbid it."""
_INVITING = re.compile(r"(?:can|could|wo|would)n?'?t")
_LIFTING = frozenset(("forget", "fail", "hesitate", "worry", "mind"))
"""After "don't" they forbid nothing of what follows."""
_UNABLE = frozenset(("can't", "cant", "cannot", "couldn't"))
"""Of oneself they are a reason and no order: "I can't reach the ham, get it"."""
_THIS_ONLY = frozenset(words_of("there here that this like right too yet now so only sure"))
"""Right after "not" they are all that it denies."""
_NOBODY = frozenset(("nobody", "noone"))
_TOLD = frozenset(("said", "says", "say", "asked", "told", "mentioned"))
"""Nobody did: then what follows is not wished."""
_JOINING = frozenset(("and", "or", "nor", "to", "you"))
"""Before a second verb they leave it under the negation of the first."""
_ANY = re.compile(r"(?:any|some|every)(?:thing|where|one|place|body)|all")
_BUT = frozenset(words_of("but except excluding other besides apart no without"))
_MEATLESS = re.compile(r".+-free|non-.+|vegetarian|vegan|meatless")
_BESIDES = frozenset(("stop", "leave"))
"""They are done with whatever else is."""
_THEN = frozenset(("and", "then"))
_ANEW = frozenset(("no", "rather", "instead", "sorry", "actually", "mean", "meant", "oh", "not"))
"""Between two acts they take back the first."""
_SIDE = frozenset(("to", "the", "left", "right"))
"""They belong to the place that they stand before: "to the left" of the plate."""
_SAME = frozenset(words_of("make do watch mind do is was if bring with in on for that as"))
"""Right before "it" they begin no act of its own: "and make it quick"."""


class Clauses(NamedTuple):
    """A phrase after its clauses were judged.

    parts: of each word, courtesy where a clause doesn't count. why: why nothing of it can be
    obeyed, "" if something can. first: what it says to do before what it is read as.
    idle: why it asks for nothing but to wait, "" if it may ask for something. holds: it asks to go
    on holding what is held.
    """

    parts: list[int]
    why: str = ""
    first: str = ""
    idle: str = ""
    holds: bool = False


def judged(said: str, parts: Sequence[int]) -> Clauses:
    """A phrase, as it is spelt, and the parts of its words, after its clauses were judged."""
    found = list(WORD.finditer(said))
    gaps = [said[one.end() : two.start()] for one, two in itertools.pairwise(found)]
    begins = frozenset(row for row, gap in enumerate(gaps, 1) if _BREAK.search(gap))
    phrase = Words(said, [one.group() for one in found], list(parts), begins)
    later = put_off(phrase, _split(phrase))
    if later == "" or (later is None and only_holds(phrase)):
        return Clauses(phrase.parts, holds=True)
    if later or was_there(said):
        return Clauses(phrase.parts, later or WAS)
    idle = TELLS if is_idle(phrase, _split(phrase)) else ""
    return _weighed(phrase)._replace(idle=idle)


def _weighed(phrase: Words) -> Clauses:
    """What of it is left to obey."""
    clauses = [clause for one in _split(phrase) for clause in _judge(phrase, one)]
    against = [(rows, why) for rows, why in clauses if why]
    kept = [row for rows, why in clauses if not why for row in rows]
    if _only_denies(phrase):
        return Clauses(phrase.parts, FORBIDS)
    if against and not phrase.tells(kept):
        return Clauses(phrase.parts, against[-1][1])
    aside = [rows for rows in _split(phrase) if tells_state(phrase, rows)]
    if not phrase.acts(row for row in kept if not any(row in rows for rows in aside)):
        aside = []
    for rows in (*(rows for rows, _ in against), *aside):
        for row in rows:
            keeps = rows in aside and phrase.parts[row] == THING  # "The cup is dirty, take it".
            phrase.parts[row] = THING if keeps else FILLER
    why = _too_much(phrase, kept)
    return Clauses(phrase.parts, why) if why else _in_turn(phrase, kept)


def _only_denies(phrase: Words) -> bool:
    """Whether it says "not that" and nothing else."""
    if phrase.tells(range(len(phrase.words))):
        return False
    denying = [row for row, word in enumerate(phrase.words) if _is_not(word)]
    acts = any(phrase.parts[row] == ACT for row in denying)
    return bool(denying) and (CONTRAST in phrase.parts if acts else ACT not in phrase.parts)


def _split(phrase: Words) -> list[range]:
    """Rows of clauses, at stops and at "but"; "anything but" is one."""
    starts = [0]
    for row, word in enumerate(phrase.words):
        since = phrase.words[starts[-1] : row]
        if row in phrase.begins or (word == "but" and not any(map(_ANY.fullmatch, since))):
            starts.append(row)
    return [range(*ends) for ends in zip(starts, [*starts[1:], len(phrase.words)], strict=True)]


def _judge(phrase: Words, rows: range) -> list[tuple[range, str]]:
    """A clause, or its two halves, each with why it can't be obeyed."""
    if _excludes(phrase, rows):
        return [(rows, EXCLUDES)]
    if asks(phrase, rows):
        return [(rows, ASKS)]
    if ALONE.search(" ".join(phrase.words[row] for row in rows)):
        return [(rows, FORBIDS)]
    begin = next((row for row in rows if _denies(phrase, row, rows)), rows.stop)
    if not _forbids(phrase, range(begin + 1, rows.stop)):
        return [(rows, "")]
    first, *others = phrase.acts(range(begin + 1, rows.stop)) or [rows.stop]
    end = next(
        (row for row in others if row > first + 1 and phrase.words[row - 1] not in _JOINING),
        rows.stop,
    )
    begin -= begin > rows.start and phrase.words[begin - 1] in ("do", "does")
    halves = (range(rows.start, begin), ""), (range(begin, end), FORBIDS)
    return [*halves, (range(end, rows.stop), "")]


def _denies(phrase: Words, row: int, rows: range) -> bool:
    """Whether a word takes back what follows it."""
    words, word = phrase.words, phrase.words[row]
    after = words[row + 1 : min(row + 3, rows.stop)]
    if word in _NOBODY or words[max(row - 1, 0) : row + 1] == ["no", "one"]:
        return bool(after) and after[0] in _TOLD
    ordered = word in _ORDERS and words[max(row - 1, 0)] not in SUBJECTS
    if not after or phrase.parts[row] not in ((ACT, FILLER) if ordered else (ACT,)):
        return False
    if word in _ENDING:
        return after[0].endswith("ing") and after[0] != "moving"
    if word == "no":
        acts = phrase.acts(range(row + 1, row + 1 + len(after)))
        return after[0] == "need" or any(words[act].endswith("ing") for act in acts)
    if not _is_not(word):
        return False
    invites = words[max(row - 1, 0)] == "why" or (_INVITING.fullmatch(word) and after[0] == "you")
    unable = word in _UNABLE and words[max(row - 1, 0)] in ("i", "we")
    only_this = word == "not" and after[0] in _THIS_ONLY
    return not (invites or unable or only_this or _LIFTING.intersection(after))


def _is_not(word: str) -> bool:
    return word in _NEVER or word.endswith("n't")


def _forbids(phrase: Words, rows: range) -> bool:
    """Whether what follows a negation is something that could be done. To hold or touch is not:
    a negation makes an act of it. To take something is if it has a name: "don't take it" is said
    of what is held."""
    placed = any(phrase.parts[row] == PLACE for row in rows)
    named = any(phrase.parts[row] == THING for row in rows)
    acts = phrase.acts(rows)
    kind = phrase.verb(acts[0]) if acts else MOVE
    if not acts and phrase.parts[rows.start : rows.start + 1] == [ACT]:  # A verb nobody listed.
        return (
            placed or named or phrase.words[rows.start + 1 : rows.start + 2] in (["it"], ["that"])
        )
    if kind == PICK:
        return placed or named
    return kind in (PUT, WAIT) or (kind == MOVE and placed)


def _excludes(phrase: Words, rows: range) -> bool:
    """Whether it says what is not meant: anything but the ham, something meat-free."""
    told = [phrase.words[row] for row in rows if phrase.parts[row] != FILLER]
    if any(map(_MEATLESS.fullmatch, told)):
        return True
    some = next((at for at, word in enumerate(told) if _ANY.fullmatch(word)), len(told))
    after = told[some + 1 :] if told[some : some + 1] != ["all"] else told[some + 1 : some + 2]
    return any(word in _BUT or _is_not(word) for word in after)


def _too_much(phrase: Words, kept: Sequence[int]) -> str:
    """Why what is wished can't be told apart: sides of places, what is taken off them, several."""
    named = any(phrase.parts[row] == THING for row in kept)
    if why := _beside(phrase, kept, named):
        return why
    puts = any(phrase.verb(row) == PUT for row in kept) and not named
    places = phrase.text(kept, PLACE)
    if SIDES.search(places) or (puts and SIDES.search(" ".join(phrase.words))):
        return SIDE
    told = phrase.text(kept, ACT, THING, PLACE)
    if not named and OFF.search(told):
        return REMOVES
    return SEVERAL if MANY.search(told) else ""


def _beside(phrase: Words, kept: Sequence[int], named: bool) -> str:
    """Why a spot beside a place can't be taken; of a thing that is picked up by its name it only
    tells where that lies, and becomes courtesy."""
    acts = phrase.acts(kept)
    for part, run in itertools.groupby(kept, key=lambda row: phrase.parts[row]):
        if part != PLACE:
            continue
        rows = list(run)
        while rows[0] and phrase.words[rows[0] - 1] in _SIDE:
            rows.insert(0, rows[0] - 1)
        if not BESIDE.match(" ".join(phrase.words[row] for row in rows)):
            continue
        if not named or not acts or phrase.verb(acts[0]) != PICK:
            return NEARBY
        for row in rows:
            phrase.parts[row] = FILLER
    return ""


def _in_turn(phrase: Words, kept: Sequence[int]) -> Clauses:
    """Two acts, one after the other, are too much, unless what is put is what was taken before."""
    acts = [row for row in phrase.acts(kept) if phrase.verb(row) in (PICK, PUT, WAIT)]
    acts = [row for row in acts if phrase.words[row] not in _BESIDES]
    if acts and (other := _another(phrase, acts[0], kept)):
        return Clauses(phrase.parts, in_turn(" ".join(phrase.words[acts[0] : other])))
    for one, two in itertools.pairwise(acts):
        between = [
            row
            for row in range(one + 1, two + 1)
            if phrase.words[row] in _THEN or row in phrase.begins
        ]
        if not between or phrase.verb(one) == phrase.verb(two):
            continue
        meanwhile = phrase.words[between[0] : two]
        if _ANEW.intersection(meanwhile) or (phrase.verb(one) == WAIT and "then" not in meanwhile):
            continue  # "Wait, put it down": the first is taken back.
        first = " ".join(phrase.words[one : between[0]])
        again = any(phrase.parts[row] == THING for row in range(two, len(phrase.words)))
        if (phrase.verb(one), phrase.verb(two)) == (PICK, PUT) and not again:
            return Clauses(phrase.parts, first=first)
        return Clauses(phrase.parts, in_turn(first))
    return Clauses(phrase.parts)


def _another(phrase: Words, act: int, kept: Sequence[int]) -> int:
    """Where an act begins that nobody here can do, after one that they can: "and hand it to me",
    "and wash it"; 0 for none."""
    for row in (row for row in kept if row > act and phrase.words[row] in _THEN):
        verb = row + 1 + (phrase.words[row + 1 : row + 2] == ["then"])
        said = phrase.words[verb : verb + 2]
        unknown = (
            len(said) > 1 and said[1] in ("it", "that", "them") and not phrase.verb(verb, PARTS)
        )
        if unknown and said[0] not in _SAME:
            return row
    return 0


def in_turn(first: str) -> str:
    """Why two acts can't be obeyed at once. first: the one that is said first."""
    return f"asks for two things; one thing at a time: say {first!r} first"
