"""Where a thing lies that a phrase names, and how it ranks: taken out before the phrase is read.

"No, the left dish" and "the dish that isn't on the right" become "no, take the dish", with a side
beside it, so that what is said of the one side is read as the same said of the other. What ranks
things or tells them by what lies beside them ("the second dish", "the dish next to the cup") is
taken out too: what remains must be one thing by itself.
"""

import itertools
import re
from collections.abc import Sequence
from typing import NamedTuple

from shared.goals.language.encoder import WORD
from shared.policies.reader.looks import ANYTHING, KINDS, NAMES
from shared.policies.reader.phrase import words_of
from shared.policies.reader.ranked import A_HEAD, DET, HEADS, puts, tidy, unranked
from shared.policies.reader.remarks import INTERJECTIONS
from shared.policies.reader.verbs import PICK, PUT, WAIT, verb_of

BOTH = "names two sides or two things by their sides: one thing at a time, by one side"
BARE = "names a side and no thing: say what lies there, 'the dish on the left'"
WHICH = "tells a thing by its side and by what it isn't: say its name"
SIDE = "names a side of a place, and only things are told apart by their sides: leave the side out"
ARM = "names an arm, and which arm moves can't be said: leave the arm out"
SIDED = "tells by a side what is to be put, and what is in the hand lies on none: call that 'it'"
PIECE = "piece"
"""What a thing is called that is told by its side alone: "the left one"."""

_SIDE = r"(?:far |very |extreme |furthest |farthest |most )?(?P<{}>left|right)(?:[- ]?most|-?hand)?"
_BEFORE = re.compile(rf"(?:\b(?P<det>{DET}) |\b){_SIDE.format('side')} (?=(?P<next>[a-z][\w'-]*))")
_REST = r"of (?:the|my|your|our) (?:table|counter|worktop|tray|two|pair|lot|scene|picture)"
_FINITE = r"(?:is|isn't|isnt|ain't|was|wasn't|does|doesn't|lies?|sits?|stands?|rests?)"
_LYING = (
    rf"(?:{_FINITE}|not|never|lying|sitting|standing|resting|placed|located|over|there|anywhere|"
    r"all the way|but|just|way|out|up|down)"
)
_AFTER = re.compile(
    rf"(?P<rel>(?:,? ?\b(?:(?:that|which|what)(?:'s|(?= {_LYING}\b))|other than|but not|except))?"
    rf"(?: ?\b{_LYING}\b)*),? ?(?P<where>"
    rf"\b(?:on|at|to|from|towards?) (?:the|your|my|our|its) {_SIDE.format('on')}(?: hand(?= side))?"
    rf"(?: (?:side|end|half|edge))?(?: {_REST})?|"
    r"\b(?:furthest|farthest|further|most)(?: (?:to|on|towards?))?(?: the)? (?P<far>left|right)|"
    rf"(?<= )the {_SIDE.format('the')} one)\b"
    r"(?! of\b|[- ](?:hand|arm|gripper|claw))"
)
_NO_THING = frozenset(
    words_of(
        "hand hands arm arms gripper claw fingers pincers place spot way side end half edge corner "
        "part bit time moment of away now in on there here into onto at to over up and or but then "
        "please bin tub box bucket container table counter tray plate sandwich stack amount order "
        "basket crate drum bowlful"
    )
)
"""After "the left" they make no thing that lies there."""
_EMPTY = ANYTHING | frozenset(words_of("the my your our that this a any other"))
_AT = frozenset(words_of("in into on onto to from off of at under by towards toward with"))
_NO_NOUN = frozenset(
    words_of("it them is are was were isn't and or up down back over go turn the a my your not")
)
_STOP = re.compile(r"[,;:.?!]| - ")
_DENYING = re.compile(
    r"\b(?:(?:and |but )?not|never|stop|rather than|instead of|other than|except|\w+n't|dont)\b"
)
_ANEW = re.compile(r"\b(?:no|nope|sorry|rather|actually|mean|meant|instead|wait|oops|whoops|not)\b")
_LEADING = INTERJECTIONS | frozenset(words_of("i mean meant said then and rather instead just"))
_INTO = re.compile(r"\b(?:in|into|on|onto) (?:the|that|your|my)\b")
_A_KIND = re.compile(rf"\b({'|'.join(sorted(KINDS))})(?:e?s)?\b")
_WRONG = re.compile(rf"\b(?:(?:that's|it's|that is) )?(?:the )?wrong {A_HEAD}\b")
_OF_THOSE = re.compile(
    r"\b((?:left|right)[\w-]* )(?:one |thing )?of (?:the|those|these) (?:two |three )?"
    rf"({'|'.join(sorted(KINDS))})(?:e?s)\b"
)
_IS = re.compile(r"(?:is|are|was|were|isn't|looks|has|had|seems|fell|'s)\b")
_ONLY_SIDE = re.compile(
    rf"(?:(?:{'|'.join(sorted(INTERJECTIONS))}|the one|not)[,;]? )*(?:(?:on|to|from|at) )?"
    r"(?:the|your|my) (?:far )?(?:left|right)(?: (?:side|please))?[?]?"
)
_SAME_AS = re.compile(rf"\b({DET} (?:\w+ )?(?:{'|'.join((*NAMES, *sorted(KINDS)))}))(?:,| -)? ?$")
_HANDED = re.compile(rf"\b(left|right) hand(?= (?:side|{A_HEAD})\b)")
_HANDS = re.compile(
    r"(?<!left or )(?<!right or )(?<!left and )(?<!right and )"
    r"(?<!\bon the )(?<!\bon your )(?<!\bto the )(?<!\bto your )(?<!\bat the )"
    r"\b(left|right)(?:-hand)? (?:hand|arm|gripper|claw|manipulator|pincers?|fingers)\b(?! side)"
)


class Located(NamedTuple):
    """A phrase without what tells where its thing lies.

    said: what remains of it. rows: those words that name the thing. side: "left" or "right", ""
    for none. two: that side only because it is not on the other, of two. ranked: it ranked things
    or told them by others. why: why none can be meant, "" if one can.
    """

    said: str
    rows: tuple[int, ...] = ()
    side: str = ""
    two: bool = False
    ranked: bool = False
    why: str = ""


class _Mark(NamedTuple):
    """A thing told by its side.

    start, end: of its name and its side. cut: of its side alone. side: "" where it tells where to
    put something. head: the noun, "" where that names nothing, "the one". denied: from where on it
    is said not to be meant, -1 where it is meant. two: told by the side where it is not.
    """

    start: int
    end: int
    cut: tuple[int, int]
    side: str
    head: str
    denied: int = -1
    two: bool = False

    def name(self, said: str) -> str:
        """What it is called, without its side."""
        return f"{said[self.start : self.cut[0]]} {said[self.cut[1] : self.end]}"


def arm_of(said: str) -> str:
    """Which arm or hand a phrase names, "left" or "right", "" where it names none or either."""
    found = _HANDS.search(_HANDED.sub(r"\1-hand", said))
    return found.group(1) if found else ""


def located(said: str) -> Located:
    """A phrase, as it is spelt, without the sides and ranks of what it names."""
    said = _OF_THOSE.sub(r"\1\2", said)
    text = unranked(_HANDED.sub(r"\1-hand", said))
    ranked = text != tidy(said)
    marks = _marks(text)
    if any(not mark.side for mark in marks):
        return Located(said, why=SIDE)
    meant = [mark for mark in marks if mark.denied < 0]
    if not meant and len(marks) == 1 and marks[0].denied > 0:
        return _other(text, marks[0])._replace(ranked=ranked)
    if not meant:
        why = BARE if _ONLY_SIDE.fullmatch(said) else ""
        if not ranked:
            return Located(said, why=why)
        words = words_of(text)
        kind = next((row for row, word in enumerate(words) if word in KINDS), None)
        return Located(text, () if kind is None else (kind,), ranked=True, why=why)
    first, last = meant[0], meant[-1]
    between = text[first.end : last.start]
    again = not last.head or _ANEW.search(between) or first.head == last.head
    if not again or (first.side != last.side and not _ANEW.search(between)):
        return Located(text, side=last.side, why=BOTH)
    named = next((one for one in reversed(marks) if one.head), None)
    if named is None and _DENYING.search(_without(text, marks)):
        return Located(text, side=last.side, why=WHICH)
    name = tidy(named.name(text)) if named else f"the {PIECE}"
    before, after = text[: first.start], text[last.end :]
    same = None if named else _SAME_AS.search(before)
    if same:  # "The dish, the left one".
        before, name = before[: same.start()], same.group(1)
    kinds = set(_A_KIND.findall(before))
    if not named and not same and len(kinds) == 1:  # "Wrong dish, the left one".
        before, name = _WRONG.sub("", before), f"the {kinds.pop()}"
    for mark in (mark for mark in marks if mark.denied >= 0):
        if mark.end <= first.start:
            before = before[: mark.denied] + before[mark.end :]
        elif mark.start >= last.end:
            after = text[last.end : mark.denied] + text[mark.end :]
    return _joined(before, re.sub(r"\bother ", "", name), after, last)


def _other(text: str, mark: _Mark) -> Located:
    """The other one, where only that is told which isn't meant: "the dish, not the left one"."""
    before = text[: mark.denied]
    if not re.search(rf"\b{A_HEAD}\W*$", before):
        return Located(text)
    begin = max((found.start() for found in re.finditer(rf"\b{DET} ", before)), default=0)
    name = re.sub(r"\bother ", "", before[begin:].strip(" ,"))
    side = "right" if mark.side == "left" else "left"
    name = name if _noun_of(name, "thing") else f"the {PIECE}"
    return _joined(before[:begin], name, text[mark.end :], mark._replace(side=side, two=True))


def _joined(before: str, name: str, after: str, mark: _Mark) -> Located:
    """What is left of a phrase around the name of its thing, an order where it was only a name."""
    before = re.sub(r"[,;] ?(?=[,;])|^[,;] ?", "", tidy(before)).strip()
    after = after.strip().rstrip(" ,;")
    clause = words_of(_STOP.split(before)[-1])
    ordered = any(verb_of(words_of(part), row) in (PICK, PUT, WAIT) for part in (before, after)
                  for row in range(len(words_of(part))))  # fmt: skip
    ordered = ordered or bool(_IS.match(after))
    if not ordered and _LEADING.issuperset(clause) and not _INTO.search(after):
        before = f"{before}{'' if before[-1:] in ',;:.?!' else ','} take".strip()
    count = len(words_of(before))
    rows = tuple(range(count, count + len(words_of(name))))
    known = words_of(name)[-1] in HEADS
    gap = "" if after[:1] in (*",;:.?!", "") else " "
    said = f"{before} {name}{gap}{after}".strip()
    return Located(said, rows if known else (), mark.side, mark.two)


def _noun_of(name: str, noun: str) -> str:
    """The noun of a name, "" where that names nothing: "the one", and not "the green one"."""
    return "" if _EMPTY.issuperset(words_of(name)) else noun


def _marks(text: str) -> list[_Mark]:
    """All things that are told by their sides, in order."""
    after = _after(text)
    inner = [mark for mark in _before(text) if not any(_overlap(mark, one) for one in after)]
    marks = sorted((*inner, *after))
    for at, (one, two) in enumerate(itertools.pairwise(marks), 1):
        between = text[one.end : two.start]
        if one.denied == two.denied >= 0 and not re.search(r"\b(?:and|or|nor)\b", between):
            marks[at] = two._replace(denied=-1)  # "Not the right dish the left one".
    return marks


def _overlap(one: _Mark, two: _Mark) -> bool:
    return one.start < two.end and two.start < one.end


def _before(text: str) -> list[_Mark]:
    """Sides before a name: "the left dish"."""
    marks = []
    for found in _BEFORE.finditer(text):
        words = words_of(text[: found.start()])
        noun = found["next"]
        known = noun in HEADS if not found["det"] else noun not in _NO_THING
        if not known or (words and words[-1] in _AT):
            continue
        end, head = _noun(text, found.end())
        cut = (found.start("side") if not found["det"] else found.end("det") + 1, found.end())
        head = _noun_of(text[found.end() : end], head)
        mark = _Mark(found.start(), end, cut, found["side"], head)
        marks.append(mark._replace(denied=_denied(text, found.start())))
    return marks


def _after(text: str) -> list[_Mark]:
    """Sides after a name: "the dish that isn't on the left"."""
    marks = []
    for found in _AFTER.finditer(text):
        side = found["on"] or found["far"] or found["the"]
        before = text[: found.start()]
        words = words_of(_STOP.split(before)[-1])
        no_noun = (
            not words
            or words[-1] in _NO_NOUN | _AT | INTERJECTIONS
            or verb_of(words, len(words) - 1)
        )
        relative = re.search(r"\b(?:that|which|what|other than|but|except)\b", found["rel"])
        told = found["the"] or re.search(rf"\b{_FINITE}\b", found["rel"])
        if (no_noun and words[-1:] not in [[kind] for kind in KINDS]) or (told and not relative):
            continue
        there = puts(before) and not _INTO.search(text[found.end() :])
        clause = len(before) - len(_STOP.split(before)[-1])
        dets = [one.start() for one in re.finditer(rf"\b{DET} ", before) if one.start() >= clause]
        start = dets[-1] if dets else before.rstrip().rfind(" ") + 1
        other = bool(_DENYING.search(found["rel"]) or " but " in f"{found['rel']} ")
        side = {"left": "right", "right": "left"}[side] if other else side
        side = "" if there else side
        head = _noun_of(text[start : found.start()], words[-1])
        mark = _Mark(start, found.end(), found.span(), side, head, two=other)
        marks.append(mark._replace(denied=_denied(text, start)))
    return marks


def _noun(text: str, start: int) -> tuple[int, str]:
    """Where a name ends that begins there, and its noun: of three words the last that is known."""
    rest = _STOP.split(text[start:])[0]
    found = list(WORD.finditer(rest))[:3]
    known = [one for one in found if one.group() in HEADS]
    last = known[0] if known else found[0]
    return start + last.end(), last.group()


def _denied(text: str, start: int) -> int:
    """From where on a name that begins there is said not to be meant, -1 where it is meant."""
    clause = max((one.end() for one in _STOP.finditer(text[:start])), default=0)
    found = list(_DENYING.finditer(text[clause:start]))
    return clause + found[0].start() if found else -1


def _without(text: str, marks: Sequence[_Mark]) -> str:
    for mark in reversed(marks):
        begin = mark.denied if mark.denied >= 0 else mark.start
        text = text[:begin] + text[mark.end :]
    return text
