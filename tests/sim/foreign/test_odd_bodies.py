"""Bodies of fewer and more parts than Adonis: all are read, and what they lack is no harm."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from adonis.dancing import run_task
from adonis.judging import Verdict, judge
from sim import Body, BodyError, World, adonis, arm7, build_body, propose, read_model
from specs import SpecError, bind_task, task_from_text

Maker = Callable[..., Path]
BACKGROUND = """
background:
  - {name: upright, primitive: get-posture, joints: [waist, neck], posture: upright}
  - {name: arms, primitive: get-posture, joints: [right_arm, left_arm], posture: rest}
  - {name: weight, primitive: compensate-gravity}
"""
LOOK = f"""task: look
tempo: 60{BACKGROUND}
subtasks: [{{name: there, primitive: look-at, at: {{point: [2, 0.5, 0.4]}}, beats: 2}}]
"""
TOUCH = f"""task: touch
tempo: 60{BACKGROUND}
subtasks:
  - {{name: out, primitive: get-posture, limb: right_arm, posture: {{arm: forward}}}}
  - {{name: hip, primitive: go-to-point, limb: right_arm, to: right_hip.front, beats: 2}}
"""

ODD = {
    "arms of 3": {"joints": 3},
    "arms of 4": {"joints": 4},
    "arms of 5": {"joints": 5},
    "arms of 6": {"joints": 6},
    "arms of 8": {"joints": 8},
    "one arm": {"arms": ("left",)},
    "no waist": {"waist": False},
    "no neck": {"neck": False},
    "neither": {"waist": False, "neck": False},
    "wheels": {"wheels": True},
    "servos": {"actuator": "position"},
    "no limits": {"limits": False},
    "nameless": {"named": False},
}


def touching(somebody: Maker, joints: int) -> tuple[Verdict, ...]:
    task = bind_task(task_from_text(TOUCH)[0], body_of(somebody, joints=joints))
    (recording,) = run_task(task)
    return tuple(judge(recording, task.spec).verdicts)


def body_of(somebody: Maker, **options: object) -> Body:
    source = read_model(somebody(**options))
    return build_body(source, propose(source, "somebody", "somebody.xml").file)


@pytest.mark.parametrize("options", ODD.values(), ids=ODD.keys())
def test_it_is_read_and_stands(options: dict[str, object], somebody: Maker) -> None:
    """Every joint that is no leg's or wheel's is there, and servos hold the body up."""
    body = body_of(somebody, **options)
    sides = options.get("arms", ("left", "right"))
    arms = {name for name in body.map.limbs if name.removesuffix("_arm") in sides}
    assert set(body.map.limbs) == arms == {f"{side}_arm" for side in sides}
    for name in arms:
        limb = body.map.limbs[name]
        assert len(limb.joints) == options.get("joints", 7)
        assert f"{limb.side}_elbow" in limb.joints
    assert len(body.map.groups["waist"]) == (3 if options.get("waist", True) else 0)
    assert len(body.map.groups["neck"]) == (2 if options.get("neck", True) else 0)
    assert body.is_free(body.home)
    world = World(body)
    gains = [body.servo(dof) for dof in range(body.nv)]
    stiffness, damping = (
        np.array([getattr(g, k) for g in gains]) for k in ("stiffness", "damping")
    )
    for _ in range(500):
        state = world.state
        off = body.home[body.qpos_of_dof] - state.qpos[:, body.qpos_of_dof]
        world.step(stiffness * off - damping * state.qvel + state.qfrc_bias)
    world.check()
    assert np.abs(world.state.qpos - body.home).max() < np.deg2rad(1.0)


def test_what_turns_the_head(somebody: Maker) -> None:
    """The neck, else the waist, else nothing."""
    turned = [
        (m.head.joints if m.head else None)
        for m in (
            body_of(somebody, neck=neck, waist=waist).map
            for neck, waist in ((True, True), (False, True), (False, False))
        )
    ]
    assert turned == [("neck",), ("waist",), None]


def test_look_at_turns_the_waist_of_a_body_without_a_neck(somebody: Maker) -> None:
    body = body_of(somebody, neck=False)
    task = bind_task(task_from_text(LOOK)[0], body)
    (recording,) = run_task(task)
    judgement = judge(recording, task.spec)
    (verdict,) = judgement.verdicts
    assert verdict.success, verdict.measures


def test_a_body_without_neck_and_waist_cannot_look(somebody: Maker) -> None:
    body = body_of(somebody, neck=False, waist=False)
    with pytest.raises(SpecError, match="no head"):
        bind_task(task_from_text(LOOK)[0], body)


@pytest.mark.parametrize("joints", [6, 7, 8])
def test_arms_of_six_to_eight_joints_touch_their_hip(joints: int, somebody: Maker) -> None:
    verdicts = touching(somebody, joints)
    assert all(verdict.success for verdict in verdicts), [v.measures for v in verdicts]


def test_an_arm_that_cannot_turn_its_palm_is_judged_to_have_missed(somebody: Maker) -> None:
    """Five joints leave the hand two directions too few: it stretches, and touches nothing."""
    out, hip = touching(somebody, 5)
    assert out.success
    assert not hip.success


def test_a_hand_without_joints_is_fixed_to_the_forearm(somebody: Maker) -> None:
    body = body_of(somebody, joints=4)
    arm = body.arm("right_arm")
    assert arm.hand != arm.forearm
    assert body.model.body_dofnum[arm.hand] == 0
    assert body.reach(arm) == pytest.approx(0.3 + 0.26, abs=0.12)


@pytest.mark.parametrize("own", [adonis, arm7])
def test_bodies_of_the_package_are_read_like_those_of_others(
    own: Callable[[], Body], tmp_path: Path
) -> None:
    """Joints, ranges, motors and gains are found again in the bare model."""
    one, path = own(), tmp_path / "somebody.xml"
    path.write_text(one.spec.to_xml())
    source = read_model(path)
    other = build_body(source, propose(source, "somebody", "somebody.xml").file)
    assert set(other.map.limbs) == set(one.map.limbs)
    for name, limb in one.map.limbs.items():
        assert other.map.limbs[name].joints == limb.joints
    assert other.map.groups == one.map.groups
    assert [other.dof_name(d) for d in range(other.nv)] == [one.dof_name(d) for d in range(one.nv)]
    assert np.allclose(other.range, one.range)
    assert np.allclose(other.torque_limit, one.torque_limit)
    for joint, servo in one.map.servos.items():
        assert other.map.servos[joint].stiffness == pytest.approx(servo.stiffness, rel=0.02)


@pytest.mark.parametrize("named", [True, False])
def test_names_are_only_evidence(named: bool, somebody: Maker) -> None:
    """The joints have the same anatomy, whatever they are called."""
    source = read_model(somebody(named=named))
    file = propose(source, "somebody", "somebody.xml").file
    assert (file.base.forward, file.base.up) == ("+x", "+z")
    arm = file.limbs["left_arm"].joints
    assert list(arm) == [
        "shoulder_y", "shoulder_x", "shoulder_z", "elbow", "wrist_z", "wrist_x", "wrist_y",
    ]  # fmt: skip
    assert [of.flipped for of in arm.values()] == [True, False, True, True, True, True, True]
    assert max(abs(of.zero) for of in arm.values()) < 1.0


def test_servos_become_motors_and_the_file_stays_as_it_is(somebody: Maker) -> None:
    path = somebody(actuator="position")
    before = path.read_text()
    source = read_model(path)
    body = build_body(source, propose(source, "somebody", "somebody.xml").file)
    assert path.read_text() == before
    assert body.torque_limit == pytest.approx(60.0)


def test_a_joint_without_a_motor_gets_what_lifts_its_load(somebody: Maker) -> None:
    source = read_model(somebody(actuator=""))
    proposal = propose(source, "somebody", "somebody.xml")
    said = proposal.file.limbs["right_arm"].joints
    assert said["shoulder_y"].torque is not None
    assert said["wrist_y"].torque is not None
    assert said["shoulder_y"].torque > 3.0 * said["wrist_y"].torque
    assert "torque" in proposal.notes["joint", "right_pitch"]


def test_a_joint_that_follows_another_moves_by_itself_which_is_said(somebody: Maker) -> None:
    source = replace(read_model(somebody()), follows={"right_tilt": "right_nod"})
    proposal = propose(source, "somebody", "somebody.xml")
    assert "right_tilt" in {j.joint for j in proposal.file.limbs["right_arm"].joints.values()}
    assert any("right_tilt (right_nod)" in said for said in proposal.said)


def test_joints_without_limits_get_half_a_turn(somebody: Maker) -> None:
    body = body_of(somebody, limits=False)
    low, high = body.range
    assert low == pytest.approx(-np.pi)
    assert high == pytest.approx(np.pi)


def test_legs_alone_are_no_body(somebody: Maker) -> None:
    path = somebody(arms=(), neck=False, waist=False)
    with pytest.raises(BodyError, match="nothing looks like an arm"):
        propose(read_model(path), "legs", "legs.xml")
