"""The errors of hl-dagger, drawn as a tree; each says what is wrong and what would be right.

HldError
├── ConfigError          a setting is unknown or out of range (exit code 2)
├── MessageError         bytes that are no message, or a message that breaks its contract
├── RefusedError         the other side answered, and said no; carries its reason
├── NoAnswerError        nobody answered in time; the sender keeps what it has and tries again
├── PolicyError          a checkpoint or a published version that cannot be used
│   └── FrozenError      a tensor of the low level changed, which must never happen
└── WorkcellError        a task, site, skill or prompt that the cell does not know
"""

import difflib
from collections.abc import Iterable


class HldError(Exception):
    """Base of every error that hl-dagger raises on purpose."""


class ConfigError(HldError):
    """A setting is unknown or out of range; the process ends with exit code 2."""


class MessageError(HldError):
    """Bytes that are no message, or a message that breaks its contract."""


class RefusedError(HldError):
    """The other side answered, and said no; `str(error)` is its reason."""


class NoAnswerError(HldError):
    """Nobody answered in time; what was sent may or may not have arrived."""


class PolicyError(HldError):
    """A checkpoint or a published version that cannot be used."""


class FrozenError(PolicyError):
    """A tensor of the low level changed between two looks at it."""


class WorkcellError(HldError):
    """A task, site, skill or prompt that the cell does not know."""


def nearest(word: str, known: Iterable[str], count: int = 3) -> str:
    """The known words nearest to `word`, as a phrase for the end of an error message."""
    known = sorted(known)
    close = difflib.get_close_matches(word, known, n=count, cutoff=0.3) or known[:count]
    return "; nearest known: " + ", ".join(repr(name) for name in close) if close else ""
