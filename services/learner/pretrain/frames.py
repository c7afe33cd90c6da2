"""Frames of a lexicon, "put {} []", taken in pieces and filled with a thing and a place."""

from shared.policies.reader.phrase import ACT, PLACE, THING, take_apart, words_of

Piece = tuple[str, int]
"""A text, and the part that its words play."""


def frame_of(frame: str) -> str:
    """A frame of the lexicon as the reader sees it."""
    pieces = fill(frame, "x", "y")
    words = [word for text, _ in pieces for word in words_of(text)]
    return take_apart(words, [part for text, part in pieces for _ in words_of(text)]).frame


def fill(frame: str, noun: str, place: str) -> list[Piece]:
    """The pieces of a frame with a thing and a place in it."""
    kinds = {"{}": (noun, THING), "[]": (place, PLACE)}
    return [kinds.get(part, (text, ACT)) for part, text in cut(frame, tuple(kinds))]


def cut(frame: str, slots: tuple[str, ...]) -> list[tuple[str, str]]:
    """The frame in pieces: (slot, "") or ("", text)."""
    pieces, rest = [], frame
    while rest:
        found = [(rest.index(slot), slot) for slot in slots if slot in rest]
        at, slot = min(found, default=(len(rest), ""))
        if rest[:at].strip():
            pieces.append(("", rest[:at].strip()))
        if slot:
            pieces.append((slot, ""))
        rest = rest[at + len(slot) :]
    return pieces
