"""People: whose token is whose. One piece for the single `token` and for a table of people.

Only hashes are kept. A token is long and random, so that a plain SHA-256 of it is enough: there is
nothing to guess that a slow hash would protect.
"""

import hashlib
import hmac
import re
import secrets
from collections.abc import Iterable, Mapping
from typing import NamedTuple

from pydantic import SecretStr

from shared.errors import RefusedError

HASHED = "sha256:"
DIGEST = re.compile(r"^[0-9a-f]{64}$")
MIN_TOKEN = 16
TOKEN_BYTES = 24
MAX_TRIED = 4  # tokens of one request


class Holder(NamedTuple):
    """Whoever has the token of this hash; without a name they call themselves as they like."""

    digest: bytes
    name: str | None


class People:
    """Who may come in."""

    def __init__(self, token: SecretStr | None, people: Mapping[str, SecretStr]) -> None:
        named = [Holder(_digest(kept), name) for name, kept in people.items()]
        self._holders = [*([Holder(_digest(token), None)] if token else []), *named]

    @property
    def guarded(self) -> bool:
        """Nobody comes in without a token."""
        return bool(self._holders)

    def find(self, tokens: Iterable[str]) -> Holder | None:
        """Whose one of these tokens is. It takes as long for a wrong one as for a right one."""
        found = None
        for token in list(tokens)[:MAX_TRIED]:
            given = hashlib.sha256(token.encode()).digest()
            for holder in self._holders:
                if hmac.compare_digest(given, holder.digest):
                    found = found or holder
        return found


def fresh_token() -> str:
    """A token that nobody guesses; its letters may stand in a header and in a WebSocket's offer."""
    return secrets.token_urlsafe(TOKEN_BYTES)


def hashed(token: str) -> str:
    """What the settings say of a token."""
    return HASHED + hashlib.sha256(token.encode()).hexdigest()


def check_kept(kept: SecretStr) -> SecretStr:
    """What the settings say of a token, if it has the form: its hash, or the token itself.

    Raises:
        ValueError: it is neither.
    """
    text = kept.get_secret_value()
    digits = text.removeprefix(HASHED)
    if text.startswith(HASHED) and not DIGEST.match(digits):
        raise ValueError(f"{HASHED} stands before 64 digits 0-9a-f; `hld token NAME` prints it")
    if len(text) < MIN_TOKEN:
        raise ValueError(f"a token has at least {MIN_TOKEN} characters; `hld token NAME` makes one")
    return kept


def same_token(kept: Iterable[SecretStr]) -> bool:
    """Two of them are one token, so that nobody could tell who speaks."""
    digests = [_digest(one) for one in kept]
    return len(set(digests)) < len(digests)


def speaker(person: str | None, author: str | None) -> str | None:
    """Under which name something is said; None: under none of their own.

    person: whose token came with it. author: what the body calls them, if anything.

    Raises:
        RefusedError: the token is somebody else's.
    """
    if person is None or author in (None, person):
        return person or author
    raise RefusedError(f"author: this token is {person}'s; leave author out, or say {person!r}")


def _digest(kept: SecretStr) -> bytes:
    text = kept.get_secret_value()
    if text.startswith(HASHED):
        return bytes.fromhex(text.removeprefix(HASHED))
    return hashlib.sha256(text.encode()).digest()
