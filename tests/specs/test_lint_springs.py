"""The springs that the lint foresees are those of the compiled fields."""

from typing import Any

import mujoco
import numpy as np
import pytest

from primitives import GetPosture, GoToPoint, Place
from primitives.primitive import FloatArray
from primitives.reach_field import ReachField
from sim import Body, State, moved, origin, places_of
from sim.springs import Pull
from specs.lint.springs import hand_springs

SECONDS = 0.8
POINT = Place(point=(0.35, -0.1, 0.35))
REACHES: dict[str, dict[str, Any]] = {
    "a place": {"to": POINT},
    "a touch": {"to": "head.back"},
    "palm, fingers and upper arm": {
        "to": POINT, "palm": "down", "fingers": (1.0, 0.3, 0.0), "upper_arm": (0.3, -1.0, 0.0),
    },
}  # fmt: skip


def scene(body: Body, seed: int) -> tuple[mujoco.MjData, FloatArray, FloatArray]:
    """A posture with kinematics, one near it in which it began, and velocities of the right arm."""
    rng, dofs = np.random.default_rng(seed), body.joints("right_arm")
    low, high = (limit[dofs] for limit in body.range)
    start = body.home.copy()
    start[body.qpos_of_dof[dofs]] = rng.uniform(0.8 * low, 0.8 * high)
    data = mujoco.MjData(body.model)
    data.qpos[:] = start
    data.qpos[body.qpos_of_dof[dofs]] += rng.uniform(-0.2, 0.2, len(dofs))
    velocity = np.zeros(body.nv)
    velocity[dofs] = rng.uniform(-2.0, 2.0, len(dofs))
    data.qvel[:] = velocity
    mujoco.mj_forward(body.model, data)
    return data, start, velocity


def check(body: Body, does: GoToPoint | GetPosture, seed: int, share: float) -> None:
    """Torques of the right arm by the lint's springs are those of the compiled field."""
    field = does.bind(body, SECONDS)
    assert isinstance(field, ReachField)
    data, start, velocity = scene(body, seed)
    arm, travel = field.arm, does.travel * SECONDS
    at_start = mujoco.MjData(body.model)
    at_start.qpos[:] = start
    mujoco.mj_forward(body.model, at_start)
    field.begin(State.of(at_start), np.array([True]))
    made = field.torque(State.of(data), np.array([share * travel]))[0, arm.dofs]
    every = moved(body, arm.dofs)
    pull = hand_springs(body, field, start, travel).pull(data, share, travel)
    asked = pull.torque - pull.damping @ velocity[every]
    np.testing.assert_array_equal(asked[len(arm.dofs) :], 0.0)  # nothing else is pulled
    atol = 0.05 + 0.005 * np.abs(made).max()
    np.testing.assert_allclose(asked[: len(arm.dofs)], made, atol=atol)


@pytest.mark.parametrize("kind", REACHES)
@pytest.mark.parametrize("share", [0.1, 0.4, 0.7, 1.2])
def test_a_reach_is_pulled_as_its_field_pulls(body: Body, kind: str, share: float) -> None:
    for seed in range(3):
        check(body, GoToPoint(limb="right_arm", **REACHES[kind]), seed, share)


@pytest.mark.parametrize("palm", ["down", "up"])
def test_a_posture_by_impedance_turns_the_palm_the_way_that_its_field_does(
    body: Body, palm: str
) -> None:
    does = GetPosture(
        limb="right_arm", controller="impedance", posture={"arm": "forward", "palm": palm}
    )
    for seed in range(3):
        check(body, does, seed, 0.6)


def test_the_stiffness_of_a_hand_is_how_its_torque_falls(body: Body) -> None:
    """By finite differences, where all springs are at rest: held as it is, nothing pulls."""
    data, posture, _ = scene(body, 1)
    arm = body.arm("right_arm")
    palm, shoulder, elbow, trunk = places_of(
        body, posture, [arm.palm, *(origin(k) for k in (arm.upper_arm, arm.forearm, arm.root))]
    )
    x, y, z = (palm - trunk).tolist()
    along = tuple((elbow - shoulder).tolist())
    does = GoToPoint(limb=arm.name, to=Place(point=(x, y, z)), upper_arm=along)
    field = does.bind(body, SECONDS)
    assert isinstance(field, ReachField)
    springs = hand_springs(body, field, posture, SECONDS)

    def pull(offset: FloatArray) -> Pull:
        data.qpos[:] = posture
        data.qpos[body.qpos_of_dof[arm.dofs]] += offset
        mujoco.mj_forward(body.model, data)
        return springs.pull(data, 0.0, SECONDS)

    here = pull(np.zeros(len(arm.dofs)))
    np.testing.assert_allclose(here.torque, 0.0, atol=1e-9)
    for k, offset in enumerate(1e-5 * np.eye(len(arm.dofs))):
        falls = (pull(-offset).torque - pull(offset).torque) / 2e-5
        np.testing.assert_allclose(here.stiffness[:, k], falls, atol=1e-3 * np.abs(falls).max())
