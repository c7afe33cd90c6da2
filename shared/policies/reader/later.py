"""What is to be done later, on a sign, or if: "pick it up when I say so", "bin it if it's dirty".

Only what is to be done now can be obeyed. To wait or to hold until then is to wait; an act that is
due then is refused, and so is one that hangs on what nobody here looks at. "When you're done" and
the like are courtesy: acts follow one another anyway.
"""

import re
from collections.abc import Sequence

from shared.policies.reader.phrase import PARTS
from shared.policies.reader.remarks import is_remark
from shared.policies.reader.verbs import HOLD, PICK, PUT, WAIT
from shared.policies.reader.wording import Words

LATER = "is to be done later or on a sign, and what is said is done at once: say it when it is time"
HANGS = "hangs on something that no robot here can judge: look, and say what is to be done"

_PEOPLE = (
    r"(?:i|we|he|she|they|someone|somebody|everyone|everybody|i'm|we're|he's|she's|they're|i've|"
    r"we've)"
)
_ANYBODY = rf"(?:{_PEOPLE}|it|it's|(?:the|my|our|his|her|their) (?:\w+ )?\w+)"
_WHEN = (
    rf"(?:(?:when|whenever|once|as soon as|the (?:moment|minute|second)) {_ANYBODY}|"
    rf"after {_PEOPLE})\b(?! (?:said|told|asked|meant|was|were|had|put|did|saw|suits?|(?:is )?done|"
    r"is convenient|convenient)\b)"
)
_IF = (
    rf"(?:if|in case) {_PEOPLE} "
    r"(?:say|says|tell|tells|ask|asks|nod|nods|call|calls|shout|shouts|wave|waves|give|gives)\b"
)
_SIGN = r"(?:on|at|upon) my (?:word|signal|mark|command|call|count|nod)\b"
_THEN = (
    r"(?:later(?: on)?|tomorrow|tonight|this evening|next (?:time|week)|(?:an|some) ?other time|"
    r"after (?:lunch|dinner|breakfast|supper|tea)|"
    r"in (?:a|an|half an|\d+|two|three|five|ten|a few) (?:minutes?|hours?|while|seconds?|days?))\b"
)
_MARK = re.compile(rf"\b(?:until|till|til|unless|{_WHEN}|{_IF}|{_SIGN}|{_THEN})(?!\w)")
_IS = r"(?:is|isn't|are|aren't|was|were|looks?|seems?|smells?|has|have)"
_CASE = re.compile(
    rf"\bif (?:(?:it|that|this|they|there)(?:'s|'re| {_IS})|"
    rf"(?:the|this|that|these|those|any) (?:\w+ )?\w+ {_IS})"
    r"(?! (?:ok|okay|fine|alright|all right|possible|convenient|handy|quicker|easier|you|what|not|"
    r"no|too|(?:too )?much)\b)(?!\w)"
)
"""A condition on the things, and no courtesy: "if it's dirty", not "if it's no trouble"."""
_FOR = re.compile(r"\b(?:wait|waiting|hang on|hold on|pause) for (?:the|my|our|that|some|a)\b")
_WHO = frozenset(("i", "we", "he", "she", "they", "someone", "somebody", "it"))
_NONE = re.compile(r"not|never|nothing|nowt|no|\w+n't|dont|cannot")
_ACTS, _WAITS = (PICK, PUT), (WAIT, HOLD)


def put_off(phrase: Words, clauses: Sequence[range]) -> str | None:
    """What a phrase asks for that speaks of a later moment: LATER, "" for waiting until then,
    HANGS where it is a condition, None where it speaks of none."""
    kinds = {row: phrase.verb(row, PARTS) for row in range(len(phrase.words))}
    acts = [row for row, kind in kinds.items() if kind in _ACTS + _WAITS]
    for rows in clauses:
        words = phrase.words[rows.start : rows.stop]
        text = " ".join(words)
        if _FOR.search(text) and not any(kinds[row] in _ACTS for row in acts):
            return ""
        if _CASE.search(text) and any(kinds[row] in _ACTS for row in acts):
            return HANGS
        found = _MARK.search(text)
        if not found or (len(clauses) > 1 and found.start() and _is_aside(words)):
            continue
        mark = rows.start + text[: found.start()].count(" ")
        before = [row for row in acts if row < mark]
        nearest = next(iter(before[::-1] or acts), len(phrase.words))
        begin = nearest if nearest < mark else mark
        denied = any(map(_NONE.fullmatch, phrase.words[rows.start : begin + 1]))
        if denied or kinds.get(nearest) in _WAITS:
            return None if any(kinds[row] in _ACTS for row in before if row < nearest) else ""
        return LATER if phrase.tells(range(len(phrase.words))) else None
    return None


def _is_aside(words: Sequence[str]) -> bool:
    """Whether a clause beside an order tells what will be: "I'll wash it later"."""
    wished = {"want", "need", "like"}.intersection(words)
    return is_remark(words) or (words[0].split("'")[0] in _WHO and not wished)
