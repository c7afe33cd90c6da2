"""Which code a round ran: the version of the package, and a hash over the sources that decide."""

import hashlib
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

PACKAGE = "hl-dagger"
ROOT = Path(__file__).parents[2]
DECIDING = ("services/learner", "shared/policies", "shared/goals", "shared/messages")
"""Folders whose code decides what a round makes of what happened."""


@cache
def code_version(root: Path = ROOT) -> str:
    """As it stands in manifests, such as "0.1.0 3f9c…": equal only for equal sources."""
    digest = hashlib.sha256()
    for folder in DECIDING:
        for file in sorted((root / folder).rglob("*.py")):
            digest.update(f"{file.relative_to(root)}\0".encode())
            digest.update(file.read_bytes())
    try:
        released = version(PACKAGE)
    except PackageNotFoundError:
        released = "unreleased"
    return f"{released} {digest.hexdigest()[:16]}"
