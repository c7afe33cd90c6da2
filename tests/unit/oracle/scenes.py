"""Scenes for the oracle: objects on the table, on the plate or in a hand, without a simulator."""

from typing import Any

import numpy as np

from services.oracle.seen import Command, Proposed, Seen
from shared.workcell.layout import BIN, PLATE_TOP_M, PLATE_XY, starts
from shared.workcell.objects import BIN as BIN_ROW
from shared.workcell.objects import BODY_NAMES, HALF_HEIGHTS_M, PLATE, absent_at, index
from shared.workcell.state import CellState

PROMPT = "make a sandwich with cheese"
CARRIED_M = 0.2


def scene(*stack: str, hand: str | None = None, seed: int = 3) -> CellState:
    """All objects on the table but those of the stack on the plate and the one in the hand."""
    positions = np.zeros((len(BODY_NAMES), 3))
    positions[:] = [absent_at(row) for row in range(len(BODY_NAMES))]
    for row, place in starts(np.random.default_rng(seed)).items():
        positions[row] = place[:3]
    positions[PLATE], positions[BIN_ROW] = (*PLATE_XY, 0.0), (BIN.x_m, BIN.y_m, 0.0)
    top = PLATE_TOP_M
    for name in stack:
        half = float(HALF_HEIGHTS_M[index(name)])
        positions[index(name)] = (*PLATE_XY, top + half)
        top += 2 * half
    held = np.array([-1, -1])
    if hand:
        positions[index(hand)] = (0.2, 0.1, CARRIED_M)
        held[0] = index(hand)
    quaternions = np.zeros((len(BODY_NAMES), 4))
    quaternions[:, 0] = 1.0
    return CellState(np.zeros(14), np.zeros((2, 4)), positions, quaternions, held)


def seen(
    state: CellState,
    executed: str,
    *,
    top: str | None = None,
    chosen_by: str = "1.0",
    previous: tuple[str, ...] = (),
    name: str = "ep-1-0",
    **fields: Any,
) -> Seen:
    """A decision in a scene; `top` is what the policy proposes, `executed` if not given."""
    return Seen(
        id=name,
        robot="robot-1",
        episode="ep-1",
        index=0,
        step=0,
        task=fields.pop("task", "sandwich"),
        prompt=fields.pop("prompt", PROMPT),
        previous=previous,
        proposed=(Proposed(goal=Command(text=top or executed), score=1.0),),
        executed=Command(text=executed),
        chosen_by=chosen_by,
        awaits_verdict=fields.pop("awaits_verdict", True),
        truth=state.to_json(),
        **fields,
    )
