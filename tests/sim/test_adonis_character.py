"""The character is the paper's: 8 moving links, 20 hinges, human masses, honest physics."""

import mujoco
import numpy as np
import pytest

from sim import Body, Replay, World, adonis
from sim.anthropometry import FEMALE, MALE


def test_it_has_the_links_and_joints_of_the_paper(body: Body) -> None:
    model = body.model
    moving = {model.body(b).name for b in range(1, model.nbody) if model.body_dofnum[b]}
    sides = ("left", "right")
    assert moving == {"trunk", "head"} | {
        f"{s}_{part}" for s in sides for part in ("upper_arm", "forearm", "hand")
    }
    assert model.nv == model.nu == 20
    assert set(model.jnt_type) == {mujoco.mjtJoint.mjJNT_HINGE.value}


@pytest.mark.parametrize("person", [MALE, FEMALE])
def test_links_weigh_what_the_table_says(person) -> None:
    model = adonis(person).model
    for link, segment in (
        ("head", person.head),
        ("trunk", person.moving_trunk),
        ("left_upper_arm", person.upper_arm),
        ("right_forearm", person.forearm),
        ("right_hand", person.hand),
    ):
        index = model.body(link).id
        assert model.body_mass[index] == pytest.approx(segment.mass)
        axes = np.empty(9)
        mujoco.mju_quat2Mat(axes, model.body_iquat[index])
        axes = axes.reshape(3, 3)
        inertia = axes @ np.diag(model.body_inertia[index]) @ axes.T
        np.testing.assert_allclose(inertia, np.diag(segment.inertia), atol=1e-6)


def test_the_moving_trunk_is_the_part_of_the_whole_trunk_above_the_waist() -> None:
    whole, part = MALE.whole_trunk, MALE.moving_trunk
    assert part.mass < whole.mass
    for moving, all_of_it in zip(part.inertia, whole.inertia, strict=True):
        assert 0 < moving < all_of_it


def test_every_joint_is_limited_in_angle_and_torque_and_is_damped(body: Body) -> None:
    model = body.model
    assert model.jnt_limited.all()
    assert model.actuator_ctrllimited.all()
    assert (model.dof_armature > 0).all()
    assert (model.dof_damping[:, 0] if model.dof_damping.ndim > 1 else model.dof_damping).min() > 0
    assert np.isfinite(body.torque_limit).all()


def test_motors_do_not_exceed_their_limits(body: Body) -> None:
    world = World(body)
    applied = world.torque
    world.step(np.full((1, body.nv), 1e4))
    np.testing.assert_allclose(applied[0], body.torque_limit)


@pytest.mark.parametrize("name", ["limits", "contacts"])
def test_limits_and_contacts_can_be_switched_off(name: str) -> None:
    model = adonis(**{name: False}).model
    if name == "limits":
        assert not model.jnt_limited.any()
    else:
        assert model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_CONTACT.value


def test_unpowered_it_falls_but_does_not_explode(body: Body) -> None:
    world = World(body, 1)
    still = np.zeros((1, body.nv))
    for _ in range(2000):
        world.step(still)
    world.check()
    assert np.abs(world.state.qvel).max() < 5.0


def test_landmarks_lie_on_the_surface_where_the_words_say(body: Body, dance) -> None:
    replay = Replay(dance.recording)

    def at(name: str) -> np.ndarray:
        return replay.site(name).position[0]

    head = replay.link("head").position[0]
    assert at("head.back")[0] < head[0] - 0.08
    for side in ("left", "right"):
        assert at(f"head.back_{side}")[0] < head[0] - 0.06, "behind the head, not beside it"
    assert at("head.back_left")[1] > 0 > at("head.back_right")[1]
    shoulder = replay.link("left_upper_arm").position[0]
    assert at("left_shoulder.top")[2] > shoulder[2] + 0.03
    assert 0 < at("left_shoulder.top")[1] < shoulder[1] + 0.02
    assert at("left_ribs")[1] > 0.08
    assert at("left_ribs")[0] > 0
    assert at("right_hip")[1] < -0.1
    model, data = body.model, mujoco.MjData(body.model)
    data.qpos[:] = body.home
    mujoco.mj_forward(model, data)
    for name in body.map.landmarks:
        site = data.site(name)
        normal = site.xmat.reshape(3, 3)[:, 0]
        hit = np.array([-1], dtype=np.int32)
        distance = mujoco.mj_ray(
            model, data, site.xpos + 0.05 * normal, -normal, None, True, -1, hit, None
        )
        link = model.geom_bodyid[hit[0]]
        assert link == model.site_bodyid[site.id], f"{name} is buried"
        assert distance == pytest.approx(0.05, abs=2e-3), f"{name} is not on the surface"


def test_at_home_nothing_touches(body: Body) -> None:
    assert body.is_free(body.home)
    assert adonis(FEMALE).is_free(adonis(FEMALE).home)


def test_angles_are_anatomical_and_the_same_for_both_sides(body: Body) -> None:
    model, data = body.model, mujoco.MjData(body.model)

    def hand(**angles: float) -> np.ndarray:
        data.qpos[:] = 0
        for joint, degrees in angles.items():
            data.joint(joint).qpos = np.deg2rad(degrees)
        mujoco.mj_kinematics(model, data)
        return data.xpos[model.body(f"{side}_hand").id].copy()

    for side, out in (("left", 1.0), ("right", -1.0)):
        hanging = hand()
        assert hand(**{f"{side}_shoulder_y": 30})[0] > hanging[0], "flexion is forward"
        assert out * (hand(**{f"{side}_shoulder_x": 30})[1] - hanging[1]) > 0, "abduction is out"
        assert hand(**{f"{side}_elbow": 60})[0] > hanging[0], "the elbow flexes forward"
        bent = hand(**{f"{side}_elbow": 90})
        turned = hand(**{f"{side}_elbow": 90, f"{side}_shoulder_z": 30})
        assert out * (turned[1] - bent[1]) < 0, "internal rotation is towards the middle"
