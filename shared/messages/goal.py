"""What the high level asks of the low level. A family is a kind of goal; language is the first."""

from typing import Literal

from shared.messages.message import Message, Text


class LanguageGoal(Message):
    """A command in words, such as "pick up the cheese".

    Source: Shi et al. 2024 (Yell At Your Robot, arXiv 2403.12910): the interface between the two
    levels is a sentence, so that a person can speak through it.
    """

    family: Literal["language"] = "language"
    text: Text


# A second family becomes a union here, told apart by `family`.
Goal = LanguageGoal
