"""Before the virtual environment exists: is this Python new enough? Standard library only."""

import sys

if sys.version_info < (3, 11):  # noqa: UP036 (whoever runs this may have less)
    have = ".".join(map(str, sys.version_info[:3]))
    sys.exit(
        f"hl-dagger needs Python 3.11 or newer, and this is {have}; try make PYTHON=python3.11"
    )
