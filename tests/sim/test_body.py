"""A body answers with indices, or says what it has."""

import mujoco
import numpy as np
import pytest

from sim import ArmWords, Body, BodyError, BodyMap, load_body, pose


@pytest.mark.parametrize(
    ("ask", "given", "exists"),
    [
        (lambda b: b.arm("middle_arm"), "middle_arm", "left_arm"),
        (lambda b: b.joints(["right_elbow", "knee"]), "knee", "right_elbow"),
        (lambda b: b.landmark("nose"), "nose", "head.back"),
        (lambda b: b.posture("yoga"), "yoga", "rest"),
        (lambda b: b.direction("sideways"), "sideways", "forward"),
        (lambda b: b.link("foot"), "foot", "trunk"),
        (lambda _: load_body("atlas"), "atlas", "adonis-female"),
    ],
)
def test_an_unknown_name_is_answered_with_those_that_exist(body: Body, ask, given, exists) -> None:
    with pytest.raises(BodyError) as caught:
        ask(body)
    assert given in str(caught.value)
    assert exists in str(caught.value)


def test_a_near_miss_is_answered_with_a_guess(body: Body) -> None:
    with pytest.raises(BodyError, match=r"did you mean 'left_shoulder\.top'"):
        body.landmark("left_sholder.top")


def test_joints_come_from_groups_limbs_and_names_without_doubles(body: Body) -> None:
    asked = body.joints(["waist", "right_arm", "right_elbow"])
    assert len(asked) == len(set(asked)) == 3 + 7
    assert len(body.joints("all")) == body.nv


def test_an_angle_outside_the_joint_is_refused(body: Body) -> None:
    with pytest.raises(BodyError, match="right_elbow cannot be 200 degrees"):
        body.angles({"right_elbow": 200.0})


@pytest.mark.parametrize("limb", ["left_arm", "right_arm"])
@pytest.mark.parametrize("palm", ["down", "up", "left"])
def test_words_become_angles_that_mean_them(body: Body, limb: str, palm: str) -> None:
    arm = body.arm(limb)
    words = ArmWords(body.direction("forward"), 0.0, body.direction(palm))
    angles = pose(body, arm, words)
    assert np.isnan(np.delete(angles, arm.dofs)).all()
    low, high = body.range
    assert (angles[arm.dofs] >= low[arm.dofs]).all()
    assert (angles[arm.dofs] <= high[arm.dofs]).all()
    data = mujoco.MjData(body.model)
    data.qpos[:] = body.home
    data.qpos[arm.dofs] = angles[arm.dofs]
    mujoco.mj_kinematics(body.model, data)
    along = data.xpos[arm.hand] - data.xpos[arm.upper_arm]
    assert along[0] / np.linalg.norm(along) > np.cos(np.deg2rad(3))
    facing = data.site(arm.limb.palm).xmat.reshape(3, 3)[:, 0]
    assert facing @ body.direction(palm) > np.cos(np.deg2rad(3))


def test_a_posture_that_no_arm_can_take_is_refused(body: Body) -> None:
    words = ArmWords(body.direction((-1.0, 1.0, 0.5)), 0.0, body.direction("up"))
    with pytest.raises(BodyError, match="right_arm cannot be held so"):
        pose(body, body.arm("right_arm"), words)


def test_a_map_that_names_what_the_model_lacks_is_refused(body: Body) -> None:
    spec = mujoco.MjSpec.from_string("<mujoco><worldbody/></mujoco>")
    with pytest.raises(BodyError):
        Body(spec, body.map)


def test_an_actuator_that_is_no_torque_motor_is_refused() -> None:
    xml = """<mujoco><worldbody><body name="arm"><joint name="hinge"/><geom size=".1"/></body>
    </worldbody><actuator><position name="servo" joint="hinge"/></actuator></mujoco>"""
    names = BodyMap(name="arm", limbs={}, postures={"rest": {}}, servos={})
    with pytest.raises(BodyError, match="'servo' is not a torque motor"):
        Body(mujoco.MjSpec.from_string(xml), names)


def test_distances_are_kept_between_capsules_only(body: Body) -> None:
    xml = """<mujoco><worldbody><body name="box"><joint name="hinge"/>
    <geom name="brick" type="box" size=".1 .1 .1"/></body></worldbody></mujoco>"""
    names = BodyMap(name="box", limbs={}, postures={"rest": {}}, servos={})
    with pytest.raises(BodyError, match="'brick' is a box"):
        Body(mujoco.MjSpec.from_string(xml), names).capsules(["box"])
    assert len(body.capsules(["head"]).geom) == 3


def test_the_model_that_is_run_is_the_one_that_is_written(body: Body) -> None:
    again = mujoco.MjModel.from_xml_string(body.xml)
    for part in ("body_mass", "geom_size", "geom_pos", "jnt_range", "site_pos"):
        np.testing.assert_array_equal(getattr(again, part), getattr(body.model, part))
