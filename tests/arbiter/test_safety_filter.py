"""The safety filter: whatever is asked for, no limit is passed."""

import numpy as np
import pytest

from adonis.dancing import run_task
from adonis.safety_study import NOISE, Outcome, attack, sign_changes, try_task
from arbiter import MARGIN, Arbiter
from arbiter.dynamics import lump_table, mass_matrix
from arbiter.safety import joint_table
from primitives import AvoidCollisions, CompensateGravity, GetPosture, GoToPoint, Place
from primitives.compiled import compiled_entry
from primitives.mechanics import Row, dof_table, link_table
from sim import Body, World
from sim import mass_matrix as mujoco_mass_matrix
from specs import Background, SpecError, SubTask, TaskSpec, bind_task, task_from_text, task_to_yaml

SEEDS = (4, 7, 8, 11, 19, 20, 428)  # those among the first that came nearest to their limits
FAR = """
task: t
safety: none
background:
  - {name: weight, primitive: compensate-gravity}
  - {name: upright, primitive: get-posture, joints: [waist, neck], posture: upright}
  - name: left
    primitive: get-posture
    joints: [left_arm]
    posture: {left_arm: 20}
subtasks:
  - {name: out, primitive: get-posture, limb: right_arm, seconds: 2, posture: {right_arm: 20}}
"""
CHATTER = 60  # sign changes of a torque per second, in an attack
HELD = 5  # those of all joints while two hands are pressed at a boundary for 1.4 s


@compiled_entry
def _mass(qpos, qvel, xpos, xmat, cdof, cvel, com, links, dofs, lumps, joints, step, whole, mass):
    x = Row(qpos, qvel, xpos, xmat, cdof, cvel, com, links, dofs)
    mass_matrix(x, lumps, joints, step, whole, mass)


def test_mass_matrix_is_mujocos(body: Body) -> None:
    rng = np.random.default_rng(0)
    world = World(body)
    joints = joint_table(body)
    for _ in range(3):
        low, high = body.range
        world.reset(rng.uniform(low, high), rng.normal(size=body.nv))
        s, mass = world.state, np.zeros((body.nv, body.nv))
        _mass(
            s.qpos[0], s.qvel[0], s.xpos[0], s.xmat[0], s.cdof[0], s.cvel[0], s.subtree_com[0],
            link_table(body), dof_table(body), lump_table(body), joints, 0.0,
            np.zeros((body.model.nbody, 10)), mass,
        )  # fmt: skip
        lower = np.tril(mujoco_mass_matrix(body, s.qpos[0]))
        assert np.abs(mass - lower).max() < 1e-12


@pytest.fixture(scope="module")
def outcomes(body: Body) -> list[tuple[Outcome, Outcome]]:
    return [(try_task(body, seed, "filter")[0], try_task(body, seed, "none")[0]) for seed in SEEDS]


def test_no_links_that_must_not_touch_come_nearer_than_their_margin(outcomes) -> None:
    for filtered, repelled in outcomes:
        assert filtered.closest > MARGIN - 0.001, filtered
        assert repelled.closest < MARGIN - 0.001, "or it was no attack"


def test_no_joint_passes_its_limit_or_its_speed(outcomes) -> None:
    for filtered, repelled in outcomes:
        assert filtered.beyond < 0.5, filtered
        assert filtered.fastest < 1.05, filtered
        assert repelled.beyond > 0.5, "or it was no attack"


def pressing(safety: str) -> TaskSpec:
    """Both hands pressed at places inside the chest and the head until the end."""
    reaches = {"right_arm": "chest.front", "left_arm": "head.left"}
    return TaskSpec(
        task="press",
        safety=safety,
        coda=1,
        background=tuple(
            Background(name=name, does=does)
            for name, does in (
                ("upright", GetPosture(joints=("waist", "neck"), posture="upright")),
                ("weight", CompensateGravity()),
                *((("guard", AvoidCollisions()),) if safety == "none" else ()),
            )
        ),
        subtasks=tuple(
            SubTask(
                name=limb,
                does=GoToPoint(limb=limb, to=Place(near=near, away=-0.06), stiffness=6000.0),
                seconds=0.6,
                after=(),
            )
            for limb, near in reaches.items()
        ),
    )


def test_torques_do_not_chatter_at_the_boundary(body: Body, outcomes) -> None:
    flips, steps = {}, {}
    for safety in ("filter", "none"):
        (recording,) = run_task(bind_task(pressing(safety), body))
        held = recording.torque[400:]  # both hands are at the boundary by now
        least = NOISE * body.torque_limit
        flips[safety] = sum(sign_changes(held[:, j], least[j]) for j in range(body.nv))
        steps[safety] = (np.abs(np.diff(held, axis=0)) / body.torque_limit).max()
    print(f"held at the boundary, sign changes {flips}, largest steps of torque {steps}")
    assert flips["filter"] <= HELD, "of all joints together"
    assert flips["filter"] < flips["none"]
    assert steps["filter"] < 0.02, "and is steady"
    for filtered, repelled in outcomes:
        print(f"{filtered.flips:.0f} sign changes a second; by repulsion {repelled.flips:.0f}")
        assert filtered.flips < CHATTER


def test_what_the_filter_changed_is_recorded_and_adds_up(body: Body) -> None:
    (recording,) = run_task(bind_task(pressing("filter"), body))
    assert recording.names[-1] == "safety"
    total = recording.contribution.sum(axis=1)
    assert np.allclose(total, recording.torque, atol=1e-3)
    assert np.abs(recording.contribution[:, -1]).max() > 1.0


def test_far_from_all_limits_nothing_is_changed(body: Body) -> None:
    plain, filtered = (
        run_task(bind_task(task_from_text(FAR.replace("none", safety))[0], body))[0]
        for safety in ("none", "filter")
    )
    assert np.array_equal(plain.qpos, filtered.qpos)


def test_alone_as_in_a_batch(body: Body) -> None:
    spec = attack(body, 3, "filter")
    task = bind_task(spec, body)
    batch = run_task(task, n=2)
    (alone,) = run_task(task)
    assert np.array_equal(batch[1].qpos, alone.qpos)


def test_safety_is_written_and_read(body: Body) -> None:
    spec = pressing("filter")
    again, _ = task_from_text(task_to_yaml(spec))
    assert again.safety == "filter"
    assert Arbiter(bind_task(again, body)).names[-1] == "safety"
    with pytest.raises(SpecError, match="safety"):
        task_from_text(task_to_yaml(spec).replace("safety: filter", "safety: perhaps"))


def test_a_primitive_cannot_be_called_as_the_filter_is(body: Body) -> None:
    spec = pressing("filter")
    named = spec.subtasks[0].model_copy(update={"name": "safety"})
    with pytest.raises(SpecError, match="'safety'"):
        bind_task(spec.model_copy(update={"subtasks": (named,)}), body)
