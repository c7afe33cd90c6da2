"""The words of a phrase, each with the part that it plays, as `clauses.py` judges them."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from shared.policies.reader.phrase import ACT, ARTICLES, DETERMINERS, PLACE, POINTING, THING
from shared.policies.reader.verbs import verb_of


class Words(NamedTuple):
    """The words of a phrase and their parts; begins: rows of words that follow a stop."""

    said: str
    words: list[str]
    parts: list[int]
    begins: frozenset[int]

    def verb(self, row: int, parts: Sequence[int] = (ACT,)) -> str:
        """The kind of verb that a word of these parts is, "" for none; a noun is none."""
        noun = row > 0 and row not in self.begins and self.words[row - 1] in DETERMINERS - {"one"}
        return "" if noun or self.parts[row] not in parts else verb_of(self.words, row)

    def acts(self, rows: Iterable[int]) -> list[int]:
        """Those rows that are verbs."""
        return [row for row in rows if self.verb(row)]

    def tells(self, rows: Iterable[int]) -> bool:
        """Whether there is something to obey in it."""
        return any(
            self.verb(row)
            or self.parts[row] == PLACE
            or (self.parts[row] == THING and self.words[row] not in POINTING | ARTICLES)
            for row in rows
        )

    def text(self, rows: Iterable[int], *parts: int) -> str:
        """The words of these parts."""
        return " ".join(self.words[row] for row in rows if self.parts[row] in parts)
