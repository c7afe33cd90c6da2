"""Names of the places on the bus: `hld/v1/<fleet>/<service>/<id>/<message>`, one writer a key.

A wildcard `*` stands for one whole chunk. Every chunk that comes from outside is checked here, so
that no id can become a wildcard or a path.
"""

import re
from typing import NamedTuple

from shared.errors import MessageError

ROOT = "hld/v1"
ACTOR = "actor"
ANY = "*"

_CHUNK = re.compile(r"[a-z0-9-]{1,64}")
_PATTERN = re.compile(r"(?:[a-z0-9-]{1,64}|\*\*?)(?:/(?:[a-z0-9-]{1,64}|\*\*?))*")


class Address(NamedTuple):
    """A key taken apart."""

    fleet: str
    service: str
    id: str
    message: str


def service_key(fleet: str, service: str, id: str, message: str) -> str:
    """The key under which the service `id` sends (or is asked) `message`.

    Raises:
        MessageError: a part is not made of 1 to 64 of a-z, 0-9 and "-".
    """
    return "/".join((ROOT, *map(_chunk, (fleet, service, id, message))))


def robot_key(fleet: str, robot: str, message: str) -> str:
    """The key of one robot's message, such as `hld/v1/lab/actor/robot-1/decision`."""
    return service_key(fleet, ACTOR, robot, message)


def any_service(fleet: str, service: str, message: str) -> str:
    """The pattern that matches `message` of every instance of a service."""
    return "/".join((ROOT, _chunk(fleet), _chunk(service), ANY, _chunk(message)))


def any_robot(fleet: str, message: str) -> str:
    """The pattern that matches `message` of every robot of the fleet."""
    return any_service(fleet, ACTOR, message)


def chunk_key(prefix: str, sha256: str, index: int | str) -> str:
    """The key of one chunk of a tensor below `prefix`; index `*` matches them all."""
    part = index if index == ANY else _chunk(str(index))
    name = sha256 if sha256 == ANY else _chunk(sha256)
    return f"{prefix}/{name}/{part}"


def parse(key: str) -> Address:
    """Take a key apart; wildcards are no keys.

    Raises:
        MessageError: the key isn't `hld/v1/<fleet>/<service>/<id>/<message>`.
    """
    head, _, rest = key.partition(f"{ROOT}/")
    parts = rest.split("/")
    if head or len(parts) != len(Address._fields) or not all(map(_CHUNK.fullmatch, parts)):
        raise MessageError(f"{key!r} is no key: {ROOT}/<fleet>/<service>/<id>/<message>")
    return Address(*parts)


def parse_chunk(key: str) -> tuple[str, int]:
    """The hash and the index that a tensor chunk's key ends with.

    Raises:
        MessageError: it doesn't end with `<sha256>/<index>`.
    """
    parts = key.split("/")
    if len(parts) < 2 or not re.fullmatch("[0-9a-f]{64}", parts[-2]):
        raise MessageError(f"{key!r} is no key of a tensor chunk: …/<sha256>/<index>")
    if not re.fullmatch("[0-9]{1,6}", parts[-1]):
        raise MessageError(f"{key!r} is no key of a tensor chunk: {parts[-1]!r} is no index")
    return parts[-2], int(parts[-1])


def check_key(key: str) -> str:
    """The key itself, if it names one place: no wildcard, no empty chunk.

    Raises:
        MessageError: it doesn't.
    """
    if not key or not all(map(_CHUNK.fullmatch, key.split("/"))):
        raise MessageError(f"{key!r} is no key: chunks of a-z, 0-9 and '-', parted by '/'")
    return key


def check_pattern(keys: str) -> str:
    """The pattern itself, if it is a key in which whole chunks may be `*` or `**`.

    Raises:
        MessageError: it isn't.
    """
    if not _PATTERN.fullmatch(keys):
        raise MessageError(f"{keys!r} is no pattern: a key whose chunks may be '*' or '**'")
    return keys


def intersects(left: str, right: str) -> bool:
    """Whether some key is matched by both patterns (a key is a pattern, too)."""
    return _meet(left.split("/"), right.split("/"))


def _meet(left: list[str], right: list[str]) -> bool:
    if not left or not right:
        return all(part == "**" for part in left or right)
    if left[0] == "**":
        return _meet(left[1:], right) or _meet(left, right[1:])
    if right[0] == "**":
        return _meet(right, left)
    same = left[0] == right[0] or ANY in (left[0], right[0])
    return same and _meet(left[1:], right[1:])


def _chunk(part: str) -> str:
    if not _CHUNK.fullmatch(part):
        raise MessageError(f"{part!r} can't stand in a key: 1 to 64 of a-z, 0-9 and '-'")
    return part
