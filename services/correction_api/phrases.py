"""Phrases: whether the newest policy knows a command, and which ones are spelt most alike."""

import difflib
from collections.abc import Sequence

from services.correction_api.views import Phrase

SHOWN = 3
ALIKE = 0.4


def look_up(text: str, known: Sequence[str]) -> Phrase | None:
    """What is known of a command; None when no policy has told its commands yet."""
    if not known:
        return None
    if text in known:
        return Phrase(known=True)
    plain = {phrase.lower(): phrase for phrase in known}
    close = difflib.get_close_matches(text.lower(), plain, n=SHOWN, cutoff=ALIKE)
    return Phrase(known=False, nearest=tuple(plain[phrase] for phrase in close))
