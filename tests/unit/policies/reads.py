"""What a reader takes a phrase for."""

import numpy as np
from numpy.typing import NDArray

from shared.messages.goal import LanguageGoal
from shared.policies.low_level import LowLevel
from shared.policies.reader.reader import Reader
from shared.workcell.objects import BODY_NAMES
from shared.workcell.skills import COMMANDS
from tests.unit.policies.scenes import senses


def read(reader: Reader, text: str, there: NDArray[np.bool_]) -> str:
    """The command, "" for none; there: [18], in the scene."""
    row = reader.read(text, there).command
    return "" if row is None else COMMANDS[row]


def scene(**at: float) -> tuple[np.ndarray, np.ndarray]:
    """Only these things lie there, each at its x."""
    body, objects = senses()
    objects[:, :] = 0.0
    for row, name in enumerate(BODY_NAMES):
        if name in at or name in ("bin", "tub"):
            objects[row, :4] = at.get(name, 0.0), 0.03 * row, 0.01, 1.0
    return body, objects


def said(low_level: LowLevel, text: str, **at: float) -> tuple[str, str]:
    """What it is taken for, and why it can't be done."""
    body, objects = scene(**at)
    goal = LanguageGoal(text=text)
    return low_level.meaning(goal, objects) or "", low_level.objection(body, objects, goal)
