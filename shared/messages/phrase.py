"""What a robot would make of a phrase if it were told it now; asked while somebody still types."""

from typing import Annotated

from pydantic import Field

from shared.messages.message import Id, Message, Step, Text


class PhraseQuestion(Message):
    """Somebody wants to know what a robot would take a phrase for; nothing is obeyed.

    text: None asks only for the commands.
    anywhere: not in the scene as it is, but whatever a scene may hold; also between two episodes.
    """

    robot: Id
    text: Text | None = None
    anywhere: bool = False


class Near(Message):
    """A known command and how near a phrase is to it; 1 is the same."""

    command: Text
    score: Annotated[float, Field(ge=0, le=1)]


class PhraseAnswer(Message):
    """How the low level reads a phrase in the scene as it is, or anywhere.

    step: the control step of that scene; 0 for anywhere.
    commands: what it knows and could do with what is in this scene; with a text none are told.
    means: the command that the phrase is taken for; None where it would be refused.
    refused: why nothing would be done; "" if something would.
    known: the phrase is one of the commands, word for word.
    nearest: possible commands, best first.
    low_level_sha256: of the low level that says so; "" from actors that didn't tell it yet.
    """

    robot: Id
    step: Step = 0
    text: Text | None = None
    commands: tuple[Text, ...] = Field(default=(), max_length=256)
    means: Text | None = None
    refused: str = ""
    known: bool = False
    nearest: tuple[Near, ...] = Field(default=(), max_length=16)
    low_level_sha256: str = Field(default="", pattern=r"^([0-9a-f]{64})?$")
