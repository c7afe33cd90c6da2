"""The physics where it fails."""

import numpy as np

from shared.workcell.cell import Cell


def test_a_step_that_diverges_is_taken_back_and_counted(caplog):
    cell = Cell("lab")
    cell.reset(np.random.default_rng(1))
    cell.move_plate(0.03, -0.12)
    before = cell.state()
    cell._data.qvel[20] = 1e12  # What a bad contact does once in a thousand episodes.
    cell.step(before.joints)
    now = cell.state()
    assert cell.diverged == 1
    assert "diverged" in caplog.text
    np.testing.assert_array_equal(now.positions, before.positions)
    np.testing.assert_allclose(now.joints, before.joints)
    cell.step(before.joints)
    assert cell.diverged == 1
    assert np.isfinite(cell.state().positions).all()


def test_a_step_that_does_not_diverge_is_kept():
    cell = Cell("lab")
    cell.reset(np.random.default_rng(1))
    before = cell.state()
    cell.step(before.joints + 0.05)
    assert cell.diverged == 0
    assert np.abs(cell.state().joints - before.joints).max() > 0.001
