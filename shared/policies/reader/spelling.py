"""Slips of the finger: a word that is nowhere known and one slip away from one that is."""

from collections.abc import Collection, Sequence

_LETTERS = "abcdefghijklmnopqrstuvwxyz"
SHORTEST = 4
"""Shorter words are left as they are: too many real words are one edit from them."""


def corrected(words: Sequence[str], known: Collection[str]) -> list[str]:
    """The words, each unknown one replaced by the first known word that is one slip away.

    A slip is two letters that changed places, a letter typed twice, or one left out within the
    word (of longer words only). A wrong letter is none: it makes too many real words of others.
    """
    return [word if word in known else _known_near(word, known) for word in words]


def _known_near(word: str, known: Collection[str]) -> str:
    if len(word) < SHORTEST or not word.isalpha():
        return word
    cuts = [(word[:at], word[at:]) for at in range(1, len(word))]
    edits = [a[:-1] + b[0] + a[-1] + b[1:] for a, b in cuts]
    edits += [a + b[1:] for a, b in cuts if a[-1] == b[0]]
    if len(word) > SHORTEST:
        edits += [a + letter + b for a, b in cuts for letter in _LETTERS]
    return next((edit for edit in edits if edit in known and len(edit) >= SHORTEST), word)
