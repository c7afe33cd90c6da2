"""People at the table: they push the plate, take things out again, lay things elsewhere."""

import numpy as np

from shared.workcell.cell import CONTROL_HZ, Cell
from shared.workcell.layout import PLATE_RADIUS_M
from shared.workcell.objects import COUNT, OBJECTS, PLATE, TUB, index
from shared.workcell.placing import FREE_SPOTS, TUB_SPOTS
from shared.workcell.state import CellState, inside, near_plate, on_table, stack_on_plate

HANDS_OFF_M = 0.14
"""Nobody reaches for what a tool is so near to."""
ROOM_M = 0.092
SHIFT_M = 0.04


class Passers:
    """Disturbs one episode at the rates of the cell's site; all chance comes from its rng.

    count: how often something was done so far.
    """

    def __init__(self, cell: Cell, rng: np.random.Generator) -> None:
        people = cell.site.people
        rates = (people.move_plate, people.put_back, people.move_thing)
        self._chances = [rate / (60.0 * CONTROL_HZ) for rate in rates]
        self._cell, self._rng, self.count = cell, rng, 0

    def pass_by(self, state: CellState, target: tuple[str, ...]) -> None:
        """One control step in which something may happen. target: what the wish is about."""
        if not any(self._chances):
            return
        deeds = (self._move_plate, self._put_back, self._move_thing)
        for chance, deed in zip(self._chances, deeds, strict=True):
            if chance and self._rng.random() < chance:
                self.count += deed(state, [index(name) for name in target])

    def _move_plate(self, state: CellState, target: list[int]) -> bool:
        del target  # Unused.
        return shift_plate(self._cell, state, self._rng)

    def _put_back(self, state: CellState, target: list[int]) -> bool:
        """The topmost thing of the stack, or something in bin or tub, to a free spot."""
        stack = stack_on_plate(state)
        packed = [item for row in (PLATE + 1, TUB) for item in inside(state, row)]
        put = [item for item in (*stack[-1:], *packed) if item in target]
        return self._lay(state, put)

    def _move_thing(self, state: CellState, target: list[int]) -> bool:
        del target  # Unused.
        return self._lay(state, [item for item in range(COUNT) if on_table(state, item)])

    def _lay(self, state: CellState, items: list[int]) -> bool:
        """One of the items, that no hand is near to, to a free spot on the table."""
        items = [item for item in items if _hands_off(state, *state.points[item][:2])]
        spots = [spot for spot in _spots(state) if _hands_off(state, *spot) and _free(state, *spot)]
        if not items or not spots:
            return False
        item = items[int(self._rng.integers(len(items)))]
        x, y = spots[int(self._rng.integers(len(spots)))]
        yaw = float(self._rng.uniform(-np.pi / 4, np.pi / 4))
        thing = OBJECTS[item]
        self._cell.place(thing.name, (x, y, thing.half_height_m + 0.001), yaw)
        return True


def shift_plate(cell: Cell, state: CellState, rng: np.random.Generator) -> bool:
    """Push the plate a few centimetres, where there is room and no hand; whether it was pushed."""
    x, y = float(rng.uniform(-SHIFT_M, SHIFT_M)), float(rng.uniform(-0.11, -0.03))
    if not state.present[PLATE] or not _hands_off(state, *state.points[PLATE][:2]):
        return False
    on_it = near_plate(state) | state.holding
    others = [at for item, at in enumerate(state.points[:COUNT]) if item not in on_it]
    if any(np.hypot(at[0] - x, at[1] - y) < PLATE_RADIUS_M + 0.036 for at in others):
        return False
    cell.move_plate(x, y)
    return True


def _spots(state: CellState) -> list[tuple[float, float]]:
    half = TUB_SPOTS if state.present[TUB] else FREE_SPOTS
    return [(side * x, y) for side in (-1.0, 1.0) for x, y in half]


def _hands_off(state: CellState, x: float, y: float) -> bool:
    return all(np.hypot(tool[0] - x, tool[1] - y) > HANDS_OFF_M for tool in state.tools)


def _free(state: CellState, x: float, y: float) -> bool:
    return all(np.hypot(at[0] - x, at[1] - y) > ROOM_M for at in state.points[:COUNT])
