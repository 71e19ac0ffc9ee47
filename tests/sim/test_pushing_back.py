"""What pushes back does so as MuJoCo's constraints do."""

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from sim import Body
from sim.pushing_back import Stops, pushed_back

FloatArray = NDArray[np.float64]
SHORT = 1e-6  # [s] half a step in which nothing goes on


def accelerations(body: Body, qpos: FloatArray, qvel: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Of all joints (nv,), by MuJoCo and by what pushes back here [rad/s^2]."""
    data = mujoco.MjData(body.model)
    data.qpos[:], data.qvel[:] = qpos, qvel
    mujoco.mj_forward(body.model, data)
    by_mujoco, rows = data.qacc.copy(), int(data.nefc)
    assert rows > 0
    dofs = np.arange(body.nv, dtype=np.int32)
    stops = Stops(body, dofs, frozenset()).found(data)
    assert len(stops) == rows
    mass = np.zeros((body.nv, body.nv))
    mujoco.mj_fullM(body.model, data, mass)
    free = qvel + SHORT * data.qacc_smooth
    here = pushed_back(stops, mass / SHORT, free, qvel, SHORT)
    return by_mujoco, (here - qvel) / SHORT


def pose(body: Body, **angles: float) -> FloatArray:
    qpos = body.home.copy()
    for joint, angle in angles.items():
        qpos[body.qpos_of_dof[body.joints(joint)]] = np.deg2rad(angle)
    return qpos


@pytest.mark.parametrize("past", [0.01, 0.04, 0.5, 3.0])
@pytest.mark.parametrize("speed", [0.0, 3.0, -3.0])
def test_the_end_of_a_joint_pushes_back(body: Body, past: float, speed: float) -> None:
    qvel = np.zeros(body.nv)
    qvel[body.joints("right_elbow")] = speed
    by_mujoco, here = accelerations(body, pose(body, right_elbow=150.0 + past), qvel)
    np.testing.assert_allclose(here, by_mujoco, atol=0.02 * np.abs(by_mujoco).max())


@pytest.mark.parametrize("sliding", [0.0, 2.0, -2.0])
def test_what_is_leant_on_pushes_back_and_rubs(body: Body, sliding: float) -> None:
    """An upper arm in the ribs, at rest and turned along them."""
    qpos = pose(body, right_shoulder_y=35.0, right_shoulder_x=-22.0, right_elbow=60.0)
    qvel = np.zeros(body.nv)
    qvel[body.joints("right_shoulder_y")] = sliding
    qvel[body.joints("right_shoulder_x")] = -1.0
    by_mujoco, here = accelerations(body, qpos, qvel)
    np.testing.assert_allclose(here, by_mujoco, atol=0.05 * np.abs(by_mujoco).max())


def test_links_that_are_passed_through_do_not_push(body: Body) -> None:
    qpos = pose(body, right_shoulder_y=35.0, right_shoulder_x=-22.0, right_elbow=60.0)
    data = mujoco.MjData(body.model)
    data.qpos[:] = qpos
    mujoco.mj_kinematics(body.model, data)
    mujoco.mj_comPos(body.model, data)
    dofs = body.joints("right_arm")
    (links,) = {stop.links for stop in Stops(body, dofs, frozenset()).found(data)}
    assert links is not None
    assert set(links) == {"trunk", "right_upper_arm"}
    assert not Stops(body, dofs, frozenset({links[::-1]})).found(data)
    other = body.joints("left_arm")
    assert not Stops(body, other, frozenset()).found(data)  # it moves neither of them
