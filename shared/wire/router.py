"""The router: the one process through which all others speak; it keeps nothing."""

import structlog
import zenoh

from shared.errors import ConfigError
from shared.wire.closing import Closing
from shared.wire.link import RouterSettings, router_config


class Router(Closing):
    """A Zenoh session in router mode, listening from the moment it is made.

    Raises:
        ConfigError: an endpoint isn't safe, isn't one, or is taken.
    """

    def __init__(self, settings: RouterSettings) -> None:
        try:
            self._session = zenoh.open(router_config(settings))
        except zenoh.ZError as error:
            listen = ", ".join(settings.endpoints)
            raise ConfigError(f"cannot listen on {listen}: {str(error)[:200]}") from None
        structlog.get_logger().info("listening", endpoints=settings.endpoints)

    def close(self) -> None:
        """Stop listening; clients notice at once and look for the next one."""
        self._session.close()  # type: ignore[no-untyped-call]  # Zenoh's stub has no types here.
