"""The arm's geometry."""

import numpy as np
import pytest

from shared.workcell.kinematics import BASE_X, forward, inverse, rotation, tool_yaw, wrap


@pytest.mark.parametrize("arm", [0, 1])
def test_forward_undoes_inverse_everywhere_an_arm_works(arm):
    rng = np.random.default_rng(arm)
    side = -1 if arm == 0 else 1
    for _ in range(200):
        x, y = side * rng.uniform(-0.05, 0.3), rng.uniform(-0.25, 0.28)
        z, yaw = rng.uniform(0.0, 0.2), rng.uniform(-np.pi, np.pi)
        joints = inverse(arm, x, y, z, rotation(arm, x, y, yaw))
        point, turn = forward(arm, np.array(joints))
        assert point == pytest.approx([x, y, z], abs=1e-12)
        assert turn[:, 0] == pytest.approx([0, 0, -1], abs=1e-12)
        assert wrap(tool_yaw(turn) - yaw, np.pi) == pytest.approx(0, abs=1e-9)


def test_a_point_out_of_reach_gets_the_arm_stretched_towards_it():
    point, _ = forward(0, np.array(inverse(0, BASE_X[0] + 1.5, 0.0, 0.1)))
    assert np.isfinite(point).all()
    assert 0.3 < point[0] - BASE_X[0] < 1.0


def test_the_simulated_tool_is_where_the_kinematics_say(cell):
    state = cell.state()
    for arm in (0, 1):
        point, turn = forward(arm, state.joints[7 * arm : 7 * arm + 6])
        assert state.tools[arm, :3] == pytest.approx(point, abs=1e-9)
        assert state.tools[arm, 3] == pytest.approx(tool_yaw(turn), abs=1e-9)
