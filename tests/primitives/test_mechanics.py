"""Forces and velocities of points agree with MuJoCo's Jacobians, in any posture."""

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from primitives.mechanics import (
    Row,
    dof_table,
    link_table,
    point_velocity,
    push_link,
    spin,
    turn_between,
    turn_error,
)
from sim import Body


def row(body: Body, seed: int) -> tuple[mujoco.MjData, Row]:
    rng = np.random.default_rng(seed)
    data = mujoco.MjData(body.model)
    data.qpos[:] = rng.uniform(-1.0, 1.0, body.model.nq)
    data.qvel[:] = rng.uniform(-2.0, 2.0, body.nv)
    mujoco.mj_forward(body.model, data)
    x = Row(
        data.qpos, data.qvel, data.xpos, data.xmat, data.cdof, data.cvel, data.subtree_com,
        link_table(body), dof_table(body),
    )  # fmt: skip
    return data, x


@settings(max_examples=30)
@given(st.integers(0, 10_000), st.sampled_from(["trunk", "head", "left_forearm", "right_hand"]))
def test_a_force_on_a_point_is_its_jacobian_transposed(body: Body, seed: int, link: str) -> None:
    data, x = row(body, seed)
    index = body.link(link)
    rng = np.random.default_rng(seed + 1)
    point, force = data.xpos[index] + rng.uniform(-0.2, 0.2, 3), rng.uniform(-50, 50, 3)
    jacobian, turning = np.zeros((3, body.nv)), np.zeros((3, body.nv))
    mujoco.mj_jac(body.model, data, jacobian, turning, point, index)
    out = np.zeros(body.nv)
    centre = data.subtree_com[body.model.body_rootid[index]]
    push_link(x, index, tuple(np.cross(point - centre, force)), tuple(force), out)
    np.testing.assert_allclose(out, jacobian.T @ force, atol=1e-9)
    np.testing.assert_allclose(
        point_velocity(x, index, tuple(point)), jacobian @ data.qvel, atol=1e-9
    )
    np.testing.assert_allclose(spin(x, index), turning @ data.qvel, atol=1e-9)


def test_the_velocity_of_a_point_is_its_finite_difference(body: Body) -> None:
    data, x = row(body, 5)
    hand = body.link("right_hand")
    local = np.array([0.02, 0.01, -0.1])
    start = data.xpos[hand] + data.xmat[hand].reshape(3, 3) @ local
    speed = point_velocity(x, hand, tuple(start))
    h = 1e-7
    mujoco.mj_integratePos(body.model, data.qpos, data.qvel, h)
    mujoco.mj_kinematics(body.model, data)
    end = data.xpos[hand] + data.xmat[hand].reshape(3, 3) @ local
    np.testing.assert_allclose(speed, (end - start) / h, atol=1e-5)


units = st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(-1, 1)).filter(
    lambda v: np.linalg.norm(v) > 0.1
).map(lambda v: tuple(np.array(v) / np.linalg.norm(v)))  # fmt: skip


@given(units, units, st.floats(0, 1))
def test_a_turn_goes_the_short_way_round_at_an_even_pace(start, goal, share: float) -> None:
    between = np.array(turn_between(start, goal, share))
    whole = np.arccos(np.clip(np.dot(start, goal), -1, 1))
    assert np.linalg.norm(between) == pytest.approx(1.0, abs=1e-6)
    assert np.arccos(np.clip(between @ start, -1, 1)) == pytest.approx(share * whole, abs=2e-3)


def test_a_turn_to_the_opposite_has_a_way() -> None:
    middle = turn_between((1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), 0.5)
    np.testing.assert_allclose(middle, (0, 0, 1), atol=1e-9)
    middle = turn_between((0.0, 0.0, 1.0), (0.0, 0.0, -1.0), 0.5)
    assert abs(middle[2]) < 1e-9


@given(units, units)
def test_the_turn_error_points_to_the_goal_and_is_bounded(current, wanted) -> None:
    error = np.array(turn_error(current, wanted))
    assert np.linalg.norm(error) <= 1.0 + 1e-9
    turned = np.array(current) + 1e-3 * np.cross(error, current)
    assert turned @ wanted >= np.dot(current, wanted) - 1e-9
