"""Phrases: whether the newest policy knows a command, and what robots tell of what they know."""

import difflib
from collections.abc import Sequence
from typing import Annotated

from pydantic import Field

from services.correction_api.views import Phrase, View
from shared.messages.message import Id
from shared.messages.phrase import Near

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


class Commands(View):
    """The commands that a robot's low level knows and could do with what is in its scene.

    asked: the robot told so; else they are those that the newest policy chooses from.
    """

    robot: Id
    commands: tuple[str, ...]
    asked: bool


class Understood(View):
    """What a robot would make of a phrase now; nothing is obeyed.

    known: it is one of the commands, word for word. means: the command that it is taken for.
    refused: why nothing would be done. nearest: commands that can be done, best first.
    """

    robot: Id
    text: str
    step: Annotated[int, Field(examples=[64])]
    known: bool
    means: Annotated[str | None, Field(examples=["pick up the cheese"])]
    refused: str
    nearest: tuple[Near, ...]
