"""The base of everything that travels: a frozen head that refuses unknown fields, plus arrays.

The head travels as JSON; arrays, where a message has them, travel beside it as safetensors
(see `shared/wire/codec.py`). Each message class declares its arrays in `ARRAYS`.
"""

import re
import uuid
from collections.abc import Mapping
from types import MappingProxyType
from typing import Annotated, Any, ClassVar, NamedTuple, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, StringConstraints, model_validator
from pydantic.json_schema import SkipJsonSchema, WithJsonSchema

from shared.errors import MessageError

ID_PATTERN = re.compile(r"^[a-z0-9-]{1,64}$")
MAX_TEXT = 200  # characters of a command or a prompt

Id = Annotated[str, StringConstraints(pattern=ID_PATTERN.pattern)]
Text = Annotated[str, StringConstraints(min_length=1, max_length=MAX_TEXT, strip_whitespace=True)]
Step = Annotated[int, Field(ge=0)]
TimeNs = Annotated[int, Field(ge=0)]
Array = Annotated[np.ndarray[Any, Any], WithJsonSchema({"type": "array"})]


class ArraySpec(NamedTuple):
    """What an array must look like: `None` in the shape stands for any length up to `limit`."""

    dtype: str
    shape: tuple[int | None, ...]
    limit: int = 1 << 22


class Message(BaseModel):
    """Something that travels: never changed after it was made.

    arrays: the arrays beside the head, as `ARRAYS` of the class declares; not part of the JSON.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", arbitrary_types_allowed=True)
    ARRAYS: ClassVar[Mapping[str, ArraySpec]] = MappingProxyType({})

    arrays: SkipJsonSchema[Mapping[str, Array]] = Field(
        default_factory=dict, exclude=True, repr=False
    )

    @model_validator(mode="after")
    def _check_arrays(self) -> Self:
        check_arrays(type(self).__name__, self.ARRAYS, self.arrays)
        return self

    def without_arrays(self) -> dict[str, Any]:
        """The head as plain JSON values."""
        return self.model_dump(mode="json")


def check_arrays(
    name: str, specs: Mapping[str, ArraySpec], arrays: Mapping[str, np.ndarray[Any, Any]]
) -> None:
    """Hold arrays against what a message declares.

    Raises:
        MessageError: an array is missing, unknown, or of another type or shape.
    """
    if set(arrays) != set(specs):
        raise MessageError(f"{name} carries arrays {sorted(arrays)}, not {sorted(specs)}")
    for key, spec in specs.items():
        array = arrays[key]
        fits = len(array.shape) == len(spec.shape) and all(
            (want is None and have <= spec.limit) or want == have
            for want, have in zip(spec.shape, array.shape, strict=True)
        )
        if str(array.dtype) != spec.dtype or not fits:
            raise MessageError(
                f"{name}.{key} is {array.dtype}{list(array.shape)}, "
                f"not {spec.dtype}{list(spec.shape)}"
            )


def new_id(prefix: str) -> str:
    """A fresh id that is valid on the wire, in a path and in a URL."""
    return f"{prefix}-{uuid.uuid4().hex[:16]}"
