"""A version of the high level, announced by the learner; its tensors follow by their hashes."""

import functools
from typing import Annotated, Any

from pydantic import Field, GetCoreSchemaHandler, StringConstraints
from pydantic_core import CoreSchema, core_schema

from shared.messages.message import Id, Message, Text, TimeNs

Sha256 = Annotated[str, StringConstraints(pattern=r"^[0-9a-f]{64}$")]


@functools.total_ordering
class Version:
    """(learner epoch, number), written "2.7": epoch grows when a learner takes over the store.

    Two learners can't both be obeyed, since the one with the lower epoch is older in everything.
    """

    __slots__ = ("epoch", "number")

    def __init__(self, epoch: int, number: int) -> None:
        self.epoch = epoch
        self.number = number

    @classmethod
    def parse(cls, text: "str | Version") -> "Version":
        """Read "2.7".

        Raises:
            ValueError: the text is not two whole numbers with a dot between.
        """
        if isinstance(text, Version):
            return text
        text = str(text)
        epoch, dot, number = text.partition(".")
        if not (dot and text.isascii() and epoch.isdecimal() and number.isdecimal()):
            raise ValueError(f"a version is EPOCH.NUMBER, such as 1.0, not {text!r}")
        return cls(int(epoch), int(number))

    def __str__(self) -> str:
        return f"{self.epoch}.{self.number}"

    def __repr__(self) -> str:
        return f"Version({self.epoch}, {self.number})"

    def __hash__(self) -> int:
        return hash((self.epoch, self.number))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Version) and self._key() == other._key()

    def __lt__(self, other: "Version") -> bool:
        return self._key() < other._key()

    def _key(self) -> tuple[int, int]:
        return (self.epoch, self.number)

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        del source, handler  # Unused.
        return core_schema.no_info_plain_validator_function(
            cls.parse,
            json_schema_input_schema=core_schema.str_schema(pattern=r"^\d+\.\d+$"),
            serialization=core_schema.plain_serializer_function_ser_schema(
                str, return_schema=core_schema.str_schema()
            ),
        )


def is_version(chosen_by: str) -> bool:
    """Whether a goal was chosen by a version, and not by what somebody said."""
    try:
        Version.parse(chosen_by)
    except ValueError:
        return False
    return True


class TensorRef(Message):
    """Where a tensor's bytes are found: they travel in chunks under the name of their hash."""

    name: str
    sha256: Sha256
    dtype: str
    shape: tuple[int, ...]
    size_bytes: Annotated[int, Field(ge=0, le=1 << 30)]


class PolicyAnnouncement(Message):
    """A version of the high level that robots shall take up: newest wins, never goes back.

    tensors: all tensors of the version; those that a robot holds already are not sent again.
    bank: the phrases that the version can propose, in order; a snapshot that belongs to it.
    low_level_sha256: the low level for which its labels were made; a robot that runs another
        one refuses the version.
    settings: what is needed to build the network around the tensors, as JSON values.
    robots: those that alone are to take it up, as a trial; none named: all. The same version may be
        announced again for all.
    """

    version: Version
    learner: Id
    created_ns: TimeNs
    tensors: tuple[TensorRef, ...] = Field(min_length=1)
    bank: tuple[Text, ...] = Field(min_length=1)
    low_level_sha256: Sha256
    settings: dict[str, int | float | str | bool] = Field(default_factory=dict)
    robots: tuple[Id, ...] = ()
