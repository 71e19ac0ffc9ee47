"""A limb that is foreseen moves by its own equation of motion."""

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from sim import Body, BodyMap, Foresight, JointSprings, World, moved
from sim.springs import Pull

FloatArray = NDArray[np.float64]
ARM = "right_arm"
WHEEL = """
<mujoco>
  <worldbody>
    <body>
      <joint name="hinge" axis="0 0 1"/>
      <geom name="rim" type="capsule" fromto="0 -0.3 0 0 0.3 0" size="0.02" mass="1"/>
    </body>
  </worldbody>
  <actuator><motor name="hinge" joint="hinge" ctrllimited="true" ctrlrange="-20 20"/></actuator>
</mujoco>"""


class Torque:
    """A torque on the first joint that never ends."""

    def __init__(self, joints: int, torque: float) -> None:
        self._pull = Pull(np.zeros(joints), np.zeros((joints, joints)), np.zeros((joints, joints)))
        self._pull.torque[0] = torque

    def pull(self, data: mujoco.MjData, share: float, travel: float) -> Pull:
        """See `sim.springs.Springs`."""
        del data, share, travel
        return self._pull


def foresight(body: Body, dofs: NDArray[np.int32], torque: float, *, carried: bool) -> Foresight:
    every = moved(body, dofs)
    held = np.tile(body.home[body.qpos_of_dof[every]], (2, 1))
    gains = [body.servo(int(dof)) for dof in every]
    servos = JointSprings(
        body, every, held,
        np.array([g.stiffness for g in gains]), np.array([g.damping for g in gains]),
    )  # fmt: skip
    return Foresight(body, dofs, body.home, Torque(len(every), torque), servos, 0.5, carried)


@pytest.mark.parametrize(("torque", "carried"), [(4.0, True), (0.0, False), (500.0, True)])
def test_it_goes_as_the_same_torques_take_it_in_the_world(
    body: Body, torque: float, carried: bool
) -> None:
    """Pushed, falling, or pushed with more than the motor has; joint by joint, without contact."""
    dofs, seconds = body.joints(ARM), 0.1
    seen = foresight(body, dofs, torque, carried=carried).in_time(1.0, seconds, 0.0)
    world = World(body, 1)
    world.reset(body.home)
    others = moved(body, dofs)[len(dofs) :]
    for _ in range(round(seconds / body.timestep)):
        state = world.state
        made = np.zeros((1, body.nv))
        for dof in others:
            servo, column = body.servo(int(dof)), body.qpos_of_dof[dof]
            off = body.home[column] - state.qpos[0, column]
            made[0, dof] = servo.stiffness * off - servo.damping * state.qvel[0, dof]
        made[0, dofs[0]] += torque
        if carried:
            made[0] += weight(body, state.qpos[0])
        left = body.joints("left_arm")
        made[0, left] = state.qfrc_bias[0, left]  # nearly: it is carried along here as if rigid
        world.step(np.clip(made, -body.torque_limit, body.torque_limit))
    columns = body.qpos_of_dof[dofs]
    gone = np.abs(world.state.qpos[0] - body.home)[columns].max()
    np.testing.assert_allclose(
        seen.at(seconds)[columns], world.state.qpos[0, columns], atol=0.05 * gone
    )


def weight(body: Body, qpos: FloatArray) -> FloatArray:
    data = mujoco.MjData(body.model)
    data.qpos[:] = qpos
    mujoco.mj_forward(body.model, data)
    bias: FloatArray = data.qfrc_bias.copy()
    return bias


def test_sight_is_lost_of_what_spins_without_end() -> None:
    wheel = Body(
        mujoco.MjSpec.from_string(WHEEL),
        BodyMap(
            name="wheel", limbs={}, postures={"rest": {"hinge": 0}},
            servos={"hinge": {"stiffness": 1, "damping": 1}},
        ),
    )  # fmt: skip
    spun = foresight(wheel, wheel.joints("hinge"), 5.0, carried=True)
    seen = spun.in_time(1.0, 20.0, 0.0)
    assert seen.lost
    assert 0.0 < seen.time[-1] < 20.0
    assert np.isfinite(seen.qpos).all()
    assert not spun.in_time(1.0, 0.1, 0.0).lost


def test_it_ends_where_links_touch_that_are_shy(body: Body) -> None:
    """The upper arm is pushed into the ribs."""
    dofs = body.joints(["right_shoulder_x"])
    pushed = foresight(body, dofs, -10.0, carried=True)
    pair = ("trunk", "right_upper_arm")
    whole = pushed.in_time(0.5, 1.0, 0.0)
    assert pair in whole.leans
    cut = pushed.in_time(0.5, 1.0, 0.0, frozenset({pair}))
    assert cut.time[-1] < whole.time[-1]
    np.testing.assert_array_equal(cut.qpos, whole.qpos[: len(cut.qpos)])


def test_all_but_limbs_that_keep_still_moves_along(body: Body) -> None:
    arm, left = body.joints(ARM), body.joints("left_arm")
    every = moved(body, arm)
    np.testing.assert_array_equal(every[: len(arm)], arm)
    assert set(every.tolist()) == set(range(body.nv)) - set(left.tolist())
    assert set(moved(body, left[:1]).tolist()) == set(range(body.nv)) - set(arm.tolist())
