"""The composition root of the oracle: the only file here that names concrete classes."""

from services.oracle.client import Client
from services.oracle.config import OracleSettings


def build(settings: OracleSettings) -> Client:
    """The oracle's only part that is not its own loop."""
    return Client(settings)
