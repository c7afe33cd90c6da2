"""What prompts say about things: names, kinds, colours, sides, and what is left out.

One table of phrases serves both ways, drawing and understanding.
"""

import itertools
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from shared.workcell.errors import UnknownPrompt
from shared.workcell.objects import KINDS, OBJECT_NAMES, OBJECTS, Stock
from shared.workcell.state import CellState


def words(text: str) -> list[str]:
    """The words of a text, in small letters."""
    return re.findall(r"[a-z]+", text.lower())


COLOURS = tuple(dict.fromkeys(item.colour for item in OBJECTS))
_MEAT = frozenset({"ham"})
_KINDS = {*KINDS, *COLOURS, "vegetarian", "meat"}
_WORDS = {
    "vegetarian": "vegetarian",
    "veggie": "vegetarian",
    "meatless": "vegetarian",
    "dishes": "dish",
    "dish": "dish",
    "tableware": "dish",
    "crockery": "dish",
    "rubbish": "rubbish",
    "trash": "rubbish",
    "litter": "rubbish",
    "waste": "rubbish",
}
_SIDES = {"left": -1.0, "right": 1.0}
_EXCEPT = r"(?:but|except(?: for)?|without|no|not|leave|leaving|hold|skip|minus)"
_NAMES = "|".join(OBJECT_NAMES)
_NAMED = re.compile(rf"\b({_NAMES})e?s?\b")
_FILL = r"(?:(?:what|that|which|those|things|anything|everything|the|any|is|are|no)(?:'s)?\s+)*"
_KIND = rf"(?:{'|'.join((*_WORDS, *COLOURS, 'meat'))})\b(?!\s+(?:bin|box|tub|crate)\b)"
_THING = rf"{_FILL}(?:(?:{'|'.join(COLOURS)})\s+)?(?:{_NAMES})e?s?\b"
_THINGS = rf"{_FILL}{_KIND}(?:\s+(?:things?|ones?|items?)\b)?"
_ONE = rf"(?:{_THING}|{_THINGS})"
_LEFT_OUT = re.compile(
    rf"\b(?:{_EXCEPT}\s+(?:out\s+)?|nothing\s+)({_ONE}(?:(?:\s*,\s*(?:and\s+)?|\s+(?:and|or)\s+){_ONE})*)"
)
_ON_A_SIDE = re.compile(
    r"\b(?:(?:on|from|to) (?:the|your|my) (left|right)\b|"
    r"(?:the|your|my) (left|right)(?:[ -]hand)?"
    rf"(?= (?:side|half|part|things|items|{'|'.join(_WORDS)}|{_NAMES})|\s*(?:[,.;!?]|$)))"
)
_NOT_ON_A_SIDE = re.compile(
    rf"\b(?:{_EXCEPT}|nothing)\s+"
    r"(?:(?:what|that|which|those|things|anything|everything|is|are|lies)(?:'s)?\s+)*"
    r"(?:(?:on|from|to) )?(?:the|your|my) (?:left|right)\b"
)
_SAID_OTHERWISE = (
    (r"’", "'"),
    (r"\bcan't\b|\bcannot\b", "can not"),
    (r"\bwon't\b", "will not"),
    (r"n't\b", " not"),
    (r"\b(?:(?:i|we)(?:'m| am|'re| are) )?allergic to\b", "no"),
    (r"\b(?:i|we) (?:do|can) not (?:really )?(?:like|want|eat|stand)\b(?! to\b)", "no"),
    (r"\b(?:i|we) (?:hate|dislike)\b(?! to\b)", "no"),
    (r"\b(?:(?:that|which) )?(?:do|does) not (?:have|contain|include)\b", "without"),
    (r"\b(?:no|without) any(?:thing)?\b", "without"),
    (r"\bnothing (?:but|except|other than)\b", "only"),
)
"""What means the same in the words that are understood."""
_ACTS = r"(?:make|build|stack|clear|clean|bus|pack|put|take|touch|move|tidy|throw|add|use)"
_NO = r"(?:not|never|no|nothing)"
_RIGHT = "say what is to be done, such as 'clear everything but the cup'"
_WRONG = (
    (rf"(?<!why )\b(?:not|never) (?:ever )?{_ACTS}\b", f"a prohibition is no wish; {_RIGHT}"),
    (rf"\b{_ACTS} nothing\b", f"that leaves nothing to do; {_RIGHT}"),
    (
        r"\b(?:left|right)(?: sides?)? (?:and|or) (?:(?:on|from|to) )?(?:(?:the|your|my) )?"
        r"(?:left|right)\b|\bboth sides\b",
        "both sides are everything; name one of them, or none",
    ),
    (rf"\b{_ACTS} (?:left|right)\b", "a side reads like 'on the left'"),
)
_UNCLEAR = re.compile(
    rf"\b(?:{_NO}\b(?! (?:else|more|other)\b)[^,.;:!?]*\b(?:(?:{_NAMES})e?s?|{_KIND})|"
    r"nothing\b(?! (?:else|more|other)\b).*)"
)
_BEFORE_NOUNS = frozenset(words("the a an some no and but without except leave with or of"))
_ORDINARY = frozenset(
    words(
        """
        a all an any away back bag be big bin blue bottom box bus busy clean clear cleared could
        crate dinner everything fast favour first food for from full great grey guest guests
        have hello hey hi hold holds hungry i if in it item items job just kitchen leave leaving
        left love lunch me meat middle minute moment more my napkins need needs next nice no not
        nothing now ok one only or order other others out plain plate please put quick quickly rest
        right robot sandwich second side sides single slice slices small stack table task that
        the them then there these thing things this those to today top tub two us vegetables
        veggies we what when whole with you your
        """
    )
)
"""Words that may stand where a thing could be named."""


@dataclass(frozen=True)
class Wish:
    """What a sentence says of the things that it is about.

    names: things that it names, in its order. traits: kinds or colours that a thing must have,
    one of each sort. sides: "left", "right", as seen at the start. but: things left out.
    without: kinds or colours of things left out.
    """

    names: tuple[str, ...] = ()
    traits: tuple[str, ...] = ()
    sides: tuple[str, ...] = ()
    but: tuple[str, ...] = ()
    without: tuple[str, ...] = ()

    @property
    def constrains(self) -> bool:
        """It says what fits, not what is wanted."""
        return bool(self.traits or self.sides or self.but or self.without)

    def fits(self, name: str) -> bool:
        """Whether a thing has all traits and is not left out, wherever it lies."""
        has = _traits(name)
        left_out = name in self.but or bool(has.intersection(self.without))
        return not left_out and has.issuperset(self.traits)

    def things(self, stock: Stock, state: CellState | None = None) -> tuple[str, ...]:
        """The things of a stock that it wishes: those that it names, or all that fit.

        state: how they lie at the start, where sides are asked for.
        """
        chosen = self.names or tuple(name for name in OBJECT_NAMES if self.fits(name))
        return tuple(name for name in chosen if name in stock and self._beside(name, state))

    def _beside(self, name: str, state: CellState | None) -> bool:
        if not self.sides or state is None:
            return True
        x = float(state.positions[OBJECT_NAMES.index(name), 0])
        return any(x * _SIDES[side] > 0 for side in self.sides)


EVERYTHING = Wish()


def read(prompt: str) -> Wish:
    """What a prompt says of things.

    Raises:
        UnknownPrompt: it names a thing that the cell doesn't have, leaves out a side, or
            contradicts itself.
    """
    text = _in_known_words(prompt)
    for pattern, why in _WRONG:
        if wrong := re.search(pattern, text):
            raise UnknownPrompt(f"{wrong.group()!r}: {why}")
    if found := _NOT_ON_A_SIDE.search(text):
        raise UnknownPrompt(
            f"{found.group()!r}: a side can't be left out; name the other side, or the things"
        )
    left_out = " , ".join(_LEFT_OUT.findall(text))
    but, without = tuple(_NAMED.findall(left_out)), _kinds(re.sub(_THING, " ", left_out))
    kept = _LEFT_OUT.sub(" ", text)
    names = tuple(_NAMED.findall(kept))
    traits = tuple(dict.fromkeys(_WORDS[word] for word in words(kept) if word in _WORDS))
    colours = tuple(
        word for word in re.findall(r"\b([a-z]+)\b(?! (?:bin|box|tub)\b)", kept) if word in COLOURS
    )
    sides = tuple(dict.fromkeys(found[1] or found[2] for found in _ON_A_SIDE.finditer(kept)))
    _refuse_strangers(text)
    if "vegetarian" in traits and _MEAT.intersection(names):
        raise UnknownPrompt(f"{prompt!r} asks for meat in something vegetarian: leave out either")
    wish = Wish(names, traits + tuple(dict.fromkeys(colours)), sides, but, without)
    _refuse_contradictions(wish, kept)
    return wish


def _in_known_words(prompt: str) -> str:
    """A prompt in small letters, without contractions, what it leaves out said plainly."""
    text = " ".join(prompt.lower().split())
    for pattern, words_ in _SAID_OTHERWISE:
        text = re.sub(pattern, words_, text)
    return text


def _refuse_contradictions(wish: Wish, kept: str) -> None:
    """kept: the prompt without what it leaves out."""
    if len(wish.sides) > 1:
        raise UnknownPrompt("both sides are everything; name one of them, or none")
    both = [
        *(name for name in wish.names if name in wish.but or _traits(name) & {*wish.without}),
        *(trait for trait in wish.traits if trait in wish.without),
    ]
    if both:
        raise UnknownPrompt(f"{both[0]!r} is asked for and left out: say one of them")
    if found := _UNCLEAR.search(kept):
        raise UnknownPrompt(
            f"{found.group()!r}: what is left out reads like 'but not the cup' or 'no tomato'"
        )


def _kinds(text: str) -> tuple[str, ...]:
    """The kinds and colours that a text names."""
    kinds = (_WORDS.get(word, word) for word in words(text))
    return tuple(dict.fromkeys(kind for kind in kinds if kind in _KINDS))


def _traits(name: str) -> set[str]:
    """A thing's kind and colour, and whether it is of meat."""
    item = OBJECTS[OBJECT_NAMES.index(name)]
    return {item.kind, item.colour, "meat" if name in _MEAT else "vegetarian"}


def _refuse_strangers(text: str) -> None:
    for before, word in itertools.pairwise(words(text)):
        if before not in _BEFORE_NOUNS:
            continue
        known = word in _ORDINARY or word in _WORDS or word in COLOURS or word in _SIDES
        if not known and not _NAMED.fullmatch(word):
            raise UnknownPrompt(
                f"there is no {word!r} in this cell; it knows {', '.join(OBJECT_NAMES)}"
            )


def listing(names: Sequence[str]) -> str:
    """The names as people list them: a, b and c."""
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def named(names: Iterable[str]) -> str:
    """The names as people list things: the a, the b and the c."""
    return listing([f"the {name}" for name in names])


assert set(_WORDS.values()) <= {"vegetarian", *KINDS}
