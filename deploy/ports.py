"""Is a port free? Asked before anything starts, since the answer of a dead child comes late."""

import socket

from shared.errors import HldError


def check_free(purpose: str, port: int) -> None:
    """Raises: HldError when somebody listens there already."""
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(("127.0.0.1", port))
        except OSError as error:
            option = "--port" if purpose == "the page" else "--router-port"
            raise HldError(
                f"port {port} for {purpose} is taken ({error.strerror}); "
                f"end what listens there or choose another with {option}"
            ) from None


def free_port() -> int:
    """A port that nobody listens on just now."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])
