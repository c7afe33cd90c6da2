"""The tensors of all versions as files named by their hash, in the folder of the run.

Files, because a version shares most of its bytes with nothing else and the database need not
carry them; by hash, so that a tensor that two versions share lies there once.
"""

import hashlib
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from shared.errors import PolicyError
from shared.messages.policy import TensorRef


class TensorFiles:
    """Bytes by their sha256. A file that has its name is whole: it is renamed into place."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        folder.mkdir(parents=True, exist_ok=True)

    def put(self, data: bytes) -> str:
        """Keep `data`; returns its sha256. On the disk when it returns."""
        sha256 = hashlib.sha256(data).hexdigest()
        path = self._folder / sha256
        if not path.exists():
            _write(path, data)
        return sha256

    def add(self, name: str, array: NDArray[Any]) -> TensorRef:
        """Keep an array, and say how an announcement refers to it."""
        data = array.tobytes()
        return TensorRef(
            name=name,
            sha256=self.put(data),
            dtype=str(array.dtype),
            shape=array.shape,
            size_bytes=len(data),
        )

    def get(self, sha256: str) -> bytes:
        """The bytes under a name.

        Raises:
            PolicyError: they are gone, or changed since they were written.
        """
        try:
            data = (self._folder / sha256).read_bytes()
        except FileNotFoundError:
            raise PolicyError(f"tensor {sha256} is missing in {self._folder}") from None
        if hashlib.sha256(data).hexdigest() != sha256:
            raise PolicyError(f"tensor {sha256} in {self._folder} has changed on the disk")
        return data

    def take(self, names: tuple[str, ...]) -> Mapping[str, bytes]:
        """Many of them by name."""
        return {name: self.get(name) for name in names}


def unpack(ref: TensorRef, data: bytes) -> NDArray[Any]:
    """The array that a reference speaks of; a view of `data`, not to be written to."""
    return np.frombuffer(data, ref.dtype).reshape(ref.shape)


def _write(path: Path, data: bytes) -> None:
    part = path.with_name(f"{path.name}.{os.getpid()}.part")
    with part.open("wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
    part.rename(path)
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)
