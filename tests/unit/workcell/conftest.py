"""One cell a test session: building a model costs more than resetting it."""

from collections.abc import Iterator

import numpy as np
import pytest

from shared.workcell.cell import Cell
from shared.workcell.env import WorkcellEnv


@pytest.fixture(scope="session")
def shared_cell() -> Iterator[Cell]:
    cell = Cell("lab")
    yield cell
    cell.close()


@pytest.fixture
def cell(shared_cell: Cell) -> Cell:
    """The lab's cell, freshly reset."""
    shared_cell.reset(np.random.default_rng(0))
    return shared_cell


@pytest.fixture(scope="session")
def env() -> Iterator[WorkcellEnv]:
    """The lab's environment; a test resets it first."""
    env = WorkcellEnv("lab")
    yield env
    env.close()
