"""Messages to bytes and back: JSON, or safetensors with the JSON head in its metadata.

Self-describing, and safe to read from a stranger: sizes are checked before anything is copied,
unknown fields are refused, and nothing in a payload can run.
"""

from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
import safetensors
from pydantic import ValidationError
from pydantic_core import from_json
from safetensors.numpy import save

from shared.errors import MessageError, nearest
from shared.messages.message import Message, check_arrays

MAX_BYTES = 8 << 20  # of one payload on the bus
MAX_HEADER_BYTES = 1 << 20  # of the JSON before the arrays
HEAD = "head"

_DTYPES = {
    "BOOL": "bool",
    "U8": "uint8",
    "I8": "int8",
    "U16": "uint16",
    "I16": "int16",
    "U32": "uint32",
    "I32": "int32",
    "U64": "uint64",
    "I64": "int64",
    "F16": "float16",
    "F32": "float32",
    "F64": "float64",
}

# Their stub has no types.
_deserialize: Callable[[bytes], list[tuple[str, dict[str, Any]]]] = safetensors.deserialize

M = TypeVar("M", bound=Message)
Arrays = dict[str, np.ndarray[Any, Any]]


def encode(message: Message, max_bytes: int = MAX_BYTES) -> bytes:
    """The bytes of a message.

    Raises:
        MessageError: they are more than `max_bytes`.
    """
    head = message.model_dump_json()
    if type(message).ARRAYS:
        arrays = {name: np.ascontiguousarray(array) for name, array in message.arrays.items()}
        data = bytes(save(arrays, metadata={HEAD: head}))
    else:
        data = head.encode()
    _check_size(type(message).__name__, len(data), max_bytes)
    return data


def decode(cls: type[M], data: bytes, max_bytes: int = MAX_BYTES) -> M:
    """The message that the bytes stand for; its arrays are views that can't be written to.

    Raises:
        MessageError: too many bytes, not in the format, or against what the class declares; the
            message says which, and what would be right.
    """
    _check_size(cls.__name__, len(data), max_bytes)
    if not cls.ARRAYS:
        return _build(cls, _parse(cls, data, data), {})
    header = _read_header(cls, data)
    head = header.get("__metadata__")
    text = head.get(HEAD) if isinstance(head, dict) else None
    if not isinstance(text, str):
        raise MessageError(f"{cls.__name__}: no {HEAD!r} in the safetensors metadata")
    return _build(cls, _parse(cls, text, data), _read_arrays(cls, data))


def _check_size(name: str, size: int, max_bytes: int) -> None:
    if size > max_bytes:
        raise MessageError(f"{name} of {size} bytes is too large: at most {max_bytes}")


def _parse(cls: type[Message], text: str | bytes, data: bytes) -> dict[str, Any]:
    try:
        tree = from_json(text, allow_inf_nan=False)
    except ValueError as error:
        raise MessageError(f"{cls.__name__}: no JSON: {error} ({data[:20]!r}…)") from None
    if not isinstance(tree, dict):
        raise MessageError(f"{cls.__name__}: the head must be an object, not {text[:20]!r}")
    return tree


def _build(cls: type[M], head: dict[str, Any], arrays: Arrays) -> M:
    if "arrays" in head:
        raise MessageError(f"{cls.__name__}: arrays travel beside the head, never in it")
    try:
        return cls.model_validate(head | {"arrays": arrays})
    except ValidationError as error:
        raise MessageError(_explain(cls, error)) from None


def _explain(cls: type[Message], error: ValidationError) -> str:
    lines = []
    for problem in error.errors(include_url=False, include_context=False)[:5]:
        path = ".".join(str(part) for part in problem["loc"])
        line = f"{cls.__name__}.{path}: {problem['msg']}".replace(".:", ":")
        if problem["type"] == "extra_forbidden" and len(problem["loc"]) == 1:
            line += nearest(path, set(cls.model_fields) - {"arrays"})
        lines.append(line)
    return "; ".join(lines)


def _read_header(cls: type[Message], data: bytes) -> dict[str, Any]:
    size = int.from_bytes(data[:8], "little")
    if len(data) < 8 or size > min(MAX_HEADER_BYTES, len(data) - 8):
        raise MessageError(f"{cls.__name__}: no safetensors: {len(data)} bytes, header {size}")
    return _parse(cls, data[8 : 8 + size], data)


def _read_arrays(cls: type[Message], data: bytes) -> Arrays:
    try:
        entries = _deserialize(data)
    except safetensors.SafetensorError as error:
        raise MessageError(f"{cls.__name__}: no safetensors: {error}") from None
    arrays = {name: _array(cls, name, entry) for name, entry in entries}
    check_arrays(cls.__name__, cls.ARRAYS, arrays)
    return arrays


def _array(cls: type[Message], name: str, entry: dict[str, Any]) -> np.ndarray[Any, Any]:
    dtype = _DTYPES.get(entry["dtype"])
    if dtype is None:
        raise MessageError(f"{cls.__name__}.{name}: type {entry['dtype']} is not for messages")
    # safetensors is little-endian by its definition, whatever this machine is.
    flat = np.frombuffer(bytes(entry["data"]), np.dtype(dtype).newbyteorder("<"))
    return flat.astype(dtype, copy=False).reshape(entry["shape"])
