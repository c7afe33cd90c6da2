"""Hear: all engines on one utterance, and whether they agree.

Two engines that took it for the same command were right in all of the utterances measured; one
alone was not. So agreement is obeyed, and anything else is for the person to choose.
"""

from collections.abc import Sequence
from typing import Annotated

from pydantic import Field

from services.correction_api.speech.engines import Engine, Heard, Sound
from services.correction_api.views import View

MIN_AGREEING = 2
MAX_TEXT = 200  # An engine that raves is cut short.


class HeardView(View):
    """What one engine heard, and the known command that it takes it for."""

    engine: Annotated[str, Field(examples=["whisper"])]
    text: Annotated[str, Field(examples=["No, pick up the keys first."])]
    command: Annotated[str | None, Field(examples=["pick up the cheese"])]


class Recognition(View):
    """What was said.

    agreed: the command that all engines, two or more, took it for. choices: else what each took it
        for, for a person to choose; none: nothing was recognised.
    """

    heard: tuple[HeardView, ...]
    agreed: str | None
    choices: tuple[str, ...]


def hear(engines: Sequence[Engine], sound: Sound, commands: tuple[str, ...]) -> Recognition:
    """What the engines make of an utterance."""
    return judge([engine.hear(sound, commands) for engine in engines])


def judge(heard: Sequence[Heard]) -> Recognition:
    """Whether what was heard may be done at once."""
    commands = [one.command for one in heard]
    agreed = commands[0] if len(heard) >= MIN_AGREEING and len(set(commands)) == 1 else None
    choices = () if agreed else tuple(dict.fromkeys(filter(None, commands)))
    views = tuple(
        HeardView(engine=one.engine, text=one.text[:MAX_TEXT], command=one.command) for one in heard
    )
    return Recognition(heard=views, agreed=agreed, choices=choices)
