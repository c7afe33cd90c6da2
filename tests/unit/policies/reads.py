"""What a reader takes a phrase for."""

import numpy as np
from numpy.typing import NDArray

from shared.policies.reader import Reader
from shared.workcell.skills import COMMANDS


def read(reader: Reader, text: str, there: NDArray[np.bool_]) -> str:
    """The command, "" for none; there: [18], in the scene."""
    row = reader.read(text, there).command
    return "" if row is None else COMMANDS[row]
