"""`hld token NAME`: a fresh token for one person, and the line of the settings that lets it in."""

from typing import Annotated

import typer

from services.correction_api.people import fresh_token, hashed
from shared.config import exit_misconfigured
from shared.errors import ConfigError
from shared.messages.message import ID_PATTERN
from shared.service import run_command


def main(
    name: Annotated[str, typer.Argument(help="who gets it: lower-case letters, digits and '-'")],
) -> None:
    """Make a token for a person. It is shown once; the settings keep only its hash."""
    if not ID_PATTERN.match(name):
        error = ConfigError(f"{name!r} is no name: use lower-case letters, digits and '-'")
        exit_misconfigured("token", error)
    token = fresh_token()
    print(f"the token of {name}, shown this once:\n\n  {token}\n")
    print("for the settings of the API; take the line out again to shut them out:\n")
    print(f'  [api.people]\n  {name} = "{hashed(token)}"')


if __name__ == "__main__":
    run_command(main)
