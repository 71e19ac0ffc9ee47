"""Laws of scaling (Hodgins & Pollard 1997, figure 3), measured in simulation."""

from functools import cache

import mujoco
import numpy as np
import pytest

from adonis.dancing import run_task
from adonis.measures import jerk_index, speed
from sim import (
    Body,
    BodyError,
    BodyMap,
    Law,
    Recording,
    Replay,
    World,
    likeness,
    load_body,
    planar_arm,
    scaled,
    scaled_gains,
)
from sim.extending import renamed
from sim.gains import Gains
from specs import Fit, TaskSpec, bind_task, load_task, refitted

SPEC, _ = load_task("macarena")


def like(spec: TaskSpec, body: Body, other: Body, length: float) -> TaskSpec:
    """A task of a body for a scale model of it."""
    fit = Fit(other.map.name, likeness(body, other, length), length**0.5)
    return refitted(spec, other, fit)


@cache
def danced(length: float) -> Recording:
    man = load_body("adonis")
    body = man if length == 1.0 else scaled(man, length, name="model")
    (recording,) = run_task(bind_task(like(SPEC, man, body, length), body), contributions=False)
    return recording


def test_a_scale_model_does_exactly_the_scaled_movement() -> None:
    """Angles are the same, times are twice as long, torques 4^4 times as large.

    Up to the first touches: there, rounding of the model's XML grows.
    """
    one, four = danced(1.0), danced(4.0)
    assert len(one.time) == len(four.time)
    np.testing.assert_allclose(four.time, 2.0 * one.time, rtol=1e-12)
    early = slice(0, 1500)
    np.testing.assert_allclose(four.qpos[early], one.qpos[early], atol=1e-4)
    np.testing.assert_allclose(2.0 * four.qvel[early], one.qvel[early], atol=1e-2)
    np.testing.assert_allclose(four.torque[early] / 256.0, one.torque[early], atol=1e-2)
    np.testing.assert_allclose(four.qpos, one.qpos, atol=0.03)


@pytest.mark.parametrize("length", [0.25, 4.0])
def test_speed_grows_as_the_root_of_length_and_jerk_shrinks_so(length: float) -> None:
    def hand(recording: Recording) -> np.ndarray:
        rows = slice(0, 1500)
        return Replay(recording).site("right_palm").position[rows]

    one, other = danced(1.0), danced(length)
    here, there = hand(one), hand(other)
    fast = speed(there, other.timestep).max() / speed(here, one.timestep).max()
    assert fast == pytest.approx(length**0.5, rel=1e-3)
    smooth = jerk_index(there, other.timestep) / jerk_index(here, one.timestep)
    assert smooth == pytest.approx(length**-0.5, rel=0.02)
    peaks = [
        np.abs(np.diff(p, 3, axis=0)).max() / r.timestep**3
        for p, r in ((here, one), (there, other))
    ]
    assert peaks[1] / peaks[0] == pytest.approx(length**-0.5, rel=0.05)


def ring(body: Body, joint: str) -> tuple[float, float]:
    """Frequency [Hz] and damping ratio of a joint that swings about its set point.

    Its servo has a twentieth of its damping, so that it rings; all others are held firmly.
    """
    dof = int(body.joints(joint)[0])
    servos = [body.servo(j) for j in range(body.nv)]
    stiffness = np.array([20.0 * servo.stiffness for servo in servos])
    damping = np.array([4.0 * servo.damping for servo in servos])
    stiffness[dof], damping[dof] = servos[dof].stiffness, 0.05 * servos[dof].damping
    world, start = World(body), body.home.copy()
    start[body.qpos_of_dof[dof]] += 0.2
    world.reset(start)
    held = body.home[body.qpos_of_dof]
    swing = []
    for _ in range(round(2.0 * body.map.time_scale / body.timestep)):
        q, v = world.state.qpos[0, body.qpos_of_dof], world.state.qvel[0]
        pull = stiffness * (held - q) - damping * v
        world.step((pull + weight_of(body, world.state.qpos[0]))[None])
        swing.append(q[dof] - held[dof])
    tops = [k for k in range(1, len(swing) - 1) if swing[k - 1] < swing[k] >= swing[k + 1]]
    assert len(tops) >= 3
    assert swing[tops[2]] > 1e-3, "it has to ring to be measured"
    decay = np.log(swing[tops[0]] / swing[tops[2]]) / (4.0 * np.pi)
    return 2.0 / ((tops[2] - tops[0]) * body.timestep), float(decay / np.hypot(1.0, decay))


def weight_of(body: Body, qpos: np.ndarray) -> np.ndarray:
    data = mujoco.MjData(body.model)
    data.qpos[:] = qpos
    mujoco.mj_forward(body.model, data)
    return data.qfrc_bias.copy()


@pytest.mark.parametrize("joint", ["right_elbow", "left_shoulder_x"])
def test_natural_frequency_follows_the_root_of_length_and_damping_ratio_nothing(joint: str) -> None:
    """omega ~ L^-1/2, and the same damping ratio: of the servos and of the passive damping."""
    man = load_body("adonis")
    frequency, ratio = ring(man, joint)
    assert 0.02 < ratio < 0.5
    for length in (0.5, 2.0):
        other = scaled(man, length)
        seen, damped = ring(other, joint)
        assert seen == pytest.approx(frequency * length**-0.5, rel=5e-3)
        assert damped == pytest.approx(ratio, rel=0.05)


def test_gains_of_unequal_segments_follow_what_each_joint_moves() -> None:
    """A heavy forearm: with gains by mass scaling it swings as fast; with the old ones, slower."""
    man = load_body("adonis")
    heavy = {f"right_{part}": Law(1.0, 3.0, 3.0) for part in ("forearm", "hand")}
    scaled_by_law = scaled(man, 1.0, segments=heavy)
    frequency, ratio = ring(man, "right_elbow")
    seen, damped = ring(scaled_by_law, "right_elbow")
    assert seen == pytest.approx(frequency, rel=0.03)
    assert damped == pytest.approx(ratio, rel=0.1)
    unscaled = renamed(scaled_by_law, man.map)
    slower, _ = ring(unscaled, "right_elbow")
    assert slower < 0.75 * frequency
    left = likeness(man, scaled_by_law).joints["left_elbow"]
    assert left.inertia == pytest.approx(1.0, rel=1e-3), "the other arm is as it was"


def test_factors_are_those_of_the_paper() -> None:
    """Figure 3: exponents of L under geometric similarity, and with M and I of their own."""
    law = Law.geometric(4.0)
    exponents = {
        "length": 1, "time": 0.5, "velocity": 0.5, "force": 3, "torque": 4, "mass": 3,
        "inertia": 5, "stiffness": 2, "damping": 2.5, "torsional_stiffness": 4,
        "torsional_damping": 4.5, "angular_velocity": -0.5, "jerk": -0.5,
    }  # fmt: skip
    for quantity, exponent in exponents.items():
        assert getattr(law, quantity) == pytest.approx(4.0**exponent), quantity
    free = Law(2.0, 3.0, 5.0)
    assert free.force == 3.0
    assert free.torque == free.torsional_stiffness == 2.5
    assert free.torsional_damping == pytest.approx(5.0 / 2.0**0.5)
    with pytest.raises(ValueError, match="factor of mass is positive"):
        Law(1.0, 0.0, 1.0)


def test_every_gain_of_a_scale_model_is_scaled() -> None:
    man = load_body("adonis")
    giant = scaled(man, 2.0)
    gains, found = scaled_gains(man, Gains.of(man.map), giant)
    assert gains.servos["right_elbow"].stiffness == pytest.approx(
        16.0 * man.map.servos["right_elbow"].stiffness, rel=1e-5
    )
    spring, own = gains.springs["left_arm"], man.map.limbs["left_arm"].spring
    powers = {
        "stiffness": 2, "damping": 2.5, "turn_stiffness": 4, "turn_damping": 4.5,
        "upper_arm_stiffness": 4, "upper_arm_damping": 4.5, "shoulder_damping": 4.5,
        "approach": 1.5, "joint_damping": 4.5,
    }  # fmt: skip
    assert set(powers) == set(type(own).model_fields), "no gain is left out"
    for gain, power in powers.items():
        assert getattr(spring, gain) == pytest.approx(getattr(own, gain) * 2.0**power, rel=1e-5)
    assert gains.guard.range == pytest.approx(0.03)
    assert gains.speed_limits["neck_x"] == pytest.approx(man.map.speed_limits["neck_x"] / 2**0.5)
    assert found.length == pytest.approx(2.0, rel=1e-5)
    np.testing.assert_allclose(giant.torque_limit, 16.0 * man.torque_limit, rtol=1e-5)
    plain, _ = scaled_gains(man, Gains.of(man.map), giant, rule="geometric")
    assert plain.servos["waist_x"].damping == pytest.approx(
        gains.servos["waist_x"].damping, rel=1e-4
    )


def test_a_body_without_arms_is_scaled_by_what_is_asked() -> None:
    arm = planar_arm()
    long = scaled(arm, 3.0)
    reach = [b.model.body("forearm").pos[1] for b in (arm, long)]
    assert reach[1] == pytest.approx(3.0 * reach[0], rel=1e-5)
    assert long.map.servos["elbow"].stiffness == pytest.approx(
        81.0 * arm.map.servos["elbow"].stiffness, rel=1e-4
    )
    with pytest.raises(BodyError, match="'planar-arm' has no arm"):
        likeness(arm, long)


def test_what_the_laws_do_not_know_is_refused() -> None:
    man = load_body("adonis")
    with pytest.raises(BodyError, match="unknown link 'tail'"):
        scaled(man, 1.0, segments={"tail": Law(1.0, 1.0, 1.0)})
    xml = """<mujoco><worldbody><body name="cart"><joint name="rail" type="slide"/>
    <geom size=".1"/></body></worldbody></mujoco>"""
    cart = Body(
        mujoco.MjSpec.from_string(xml),
        BodyMap(name="cart", limbs={}, postures={"rest": {}}, servos={}),
    )
    with pytest.raises(BodyError, match="'rail' is none"):
        scaled(cart, 2.0)
