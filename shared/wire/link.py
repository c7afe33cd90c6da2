"""From settings to Zenoh configurations: which endpoints are safe, what a link is set to."""

import ipaddress
import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Protocol

import zenoh
from pydantic import Field

from shared.config import Settings
from shared.errors import ConfigError
from shared.wire.bus import BusSettings
from shared.wire.codec import MAX_BYTES

_ENDPOINT = re.compile(r"(tcp|tls)/(\[[0-9a-fA-F:.]+\]|[A-Za-z0-9._-]+):([0-9]{1,5})")
_UNIX = re.compile(r"unixsock-stream/(/[A-Za-z0-9._/-]+)")
_ATTEMPT_MS = 500  # one try to reach the router; ZenohBus repeats it until it is closed
# A full queue that doesn't move for so long closes its link. The router gives a client up long
# before the others give up the router, else one that hangs would cost all of them their links.
_ROUTER_BLOCK_US = 1_000_000
_CLIENT_BLOCK_US = 5_000_000


class RouterSettings(Settings):
    """Where the router listens.

    listen: endpoints; beyond this machine only tls/ADDRESS:PORT. None given: this machine alone,
        at `port`.
    ca_certificate, certificate, private_key: PEM files; a client must show a certificate that
        the same authority signed. All three or none.
    users: a file with lines USER:PASSWORD; then a client must name itself as well.
    lease_ms: silence after which a client counts as gone.
    """

    listen: tuple[str, ...] = ()
    port: Annotated[int, Field(ge=1, le=65535)] = 7447
    ca_certificate: Path | None = None
    certificate: Path | None = None
    private_key: Path | None = None
    users: Path | None = None
    lease_ms: Annotated[int, Field(ge=500, le=60_000)] = 2000

    @property
    def endpoints(self) -> tuple[str, ...]:
        """Where it listens."""
        return self.listen or (f"tcp/127.0.0.1:{self.port}",)


class Certificates(Protocol):
    """The three files that both kinds of settings have."""

    @property
    def ca_certificate(self) -> Path | None: ...

    @property
    def certificate(self) -> Path | None: ...

    @property
    def private_key(self) -> Path | None: ...


def client_config(settings: BusSettings) -> zenoh.Config:
    """The configuration of a service's session.

    Raises:
        ConfigError: an endpoint or a file that can't be used; says what would be right.
    """
    files = _files(settings)
    for endpoint in settings.connect:
        _check_endpoint("connect", endpoint, tls=bool(files))
    if (settings.user is None) != (settings.password is None):
        raise ConfigError("user and password belong together: give both or none")
    tree = _link(settings.lease_ms, _CLIENT_BLOCK_US) | {
        "mode": "client",
        "connect/endpoints": list(settings.connect),
        "connect/timeout_ms": _ATTEMPT_MS,
        "connect/exit_on_failure": True,
        "connect/retry": {
            "period_init_ms": 100,
            "period_max_ms": 500,
            "period_increase_factor": 2,
        },
    }
    if settings.user is not None and settings.password is not None:
        tree["transport/auth/usrpwd/user"] = settings.user
        tree["transport/auth/usrpwd/password"] = settings.password.get_secret_value()
    return _build(tree | _tls(files, "connect"))


def router_config(settings: RouterSettings) -> zenoh.Config:
    """The configuration of the router's session.

    Raises:
        ConfigError: an endpoint or a file that can't be used; says what would be right.
    """
    files = _files(settings)
    for endpoint in settings.endpoints:
        _check_endpoint("listen", endpoint, tls=bool(files))
    tree = _link(settings.lease_ms, _ROUTER_BLOCK_US) | {
        "mode": "router",
        "listen/endpoints": list(settings.endpoints),
        "listen/exit_on_failure": True,
    }
    if settings.users is not None:
        tree["transport/auth/usrpwd/dictionary_file"] = str(_readable("users", settings.users))
    return _build(tree | _tls(files, "listen"))


def _link(lease_ms: int, block_us: int) -> dict[str, Any]:
    """What holds for both ends. `lowlatency` stays off: it loses 50 kB and more in silence."""
    return {
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        "transport/unicast/open_timeout": 2000,
        "transport/unicast/accept_timeout": 2000,
        "transport/link/tx/lease": lease_ms,
        "transport/link/tx/queue/congestion_control/block/wait_before_close": block_us,
        "transport/link/rx/max_message_size": 2 * MAX_BYTES,
    }


def _tls(files: Mapping[str, str], side: str) -> dict[str, Any]:
    if not files:
        return {}
    return {
        "transport/link/tls/root_ca_certificate": files["ca_certificate"],
        "transport/link/tls/enable_mtls": True,
        "transport/link/tls/verify_name_on_connect": True,
        "transport/link/tls/close_link_on_expiration": True,
        f"transport/link/tls/{side}_certificate": files["certificate"],
        f"transport/link/tls/{side}_private_key": files["private_key"],
    }


def _files(settings: Certificates) -> dict[str, str]:
    paths = {
        "ca_certificate": settings.ca_certificate,
        "certificate": settings.certificate,
        "private_key": settings.private_key,
    }
    given = {name: path for name, path in paths.items() if path is not None}
    if given and len(given) < len(paths):
        missing = ", ".join(sorted(set(paths) - set(given)))
        raise ConfigError(f"TLS needs all of {', '.join(paths)}; missing: {missing}")
    return {name: str(_readable(name, path)) for name, path in given.items()}


def _readable(name: str, path: Path) -> Path:
    if not path.is_file():
        raise ConfigError(f"{name}: there is no file {path}")
    return path


def _check_endpoint(name: str, endpoint: str, *, tls: bool) -> None:
    if _UNIX.fullmatch(endpoint):
        return
    match = _ENDPOINT.fullmatch(endpoint)
    if not match or int(match[3]) > 65535:
        raise ConfigError(
            f"{name}: {endpoint!r} is no endpoint; right would be tcp/127.0.0.1:7447, "
            "tls/robots.example.org:7447 or unixsock-stream//run/hld.sock"
        )
    protocol, host, port = match.groups()
    if protocol == "tls" and not tls:
        raise ConfigError(
            f"{name}: {endpoint} needs ca_certificate, certificate and private_key (PEM files)"
        )
    if protocol == "tcp" and not _is_loopback(host.strip("[]")):
        raise ConfigError(
            f"{name}: {endpoint} is open to the network, in clear and for anybody; right would "
            f"be tls/{host}:{port} with ca_certificate, certificate and private_key, or "
            f"tcp/127.0.0.1:{port} for this machine alone"
        )


def _is_loopback(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def _build(tree: Mapping[str, Any]) -> zenoh.Config:
    config = zenoh.Config()
    for key, value in tree.items():
        config.insert_json5(key, json.dumps(value))
    return config
