"""Hashes over source files: equal only for equal code, wherever it is installed."""

import hashlib
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).parents[1]


def sha256_code(patterns: Iterable[str], root: Path = ROOT) -> str:
    """Over names and contents of the files that match, as `Path.glob` takes patterns, in order."""
    digest = hashlib.sha256()
    for pattern in patterns:
        for file in sorted(root.glob(pattern)):
            digest.update(f"{file.relative_to(root)}\0".encode())
            digest.update(file.read_bytes())
    return digest.hexdigest()
