"""look-at, point-at, follow, hold and relax: their equations, and whether they do it."""

from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.interpolate import CubicSpline

from adonis.dancing import run_task
from adonis.judging import judge
from primitives import Follow, Hold, LookAt, PointAt, PrimitiveError, Relax, Trajectory
from primitives.testing import Trial
from sim import Body, BodyError, Recording, planar_arm
from specs import SpecError, bind_task, load_task, task_from_text

ROOT = Path(__file__).parents[2]
LATE = 50.0  # [s] by then everything has set in
TASK = """
task: t
background:
  - {name: upright, primitive: get-posture, joints: [waist, neck], posture: upright}
  - {name: arms, primitive: get-posture, joints: [right_arm, left_arm], posture: rest}
  - {name: weight, primitive: compensate-gravity}
subtasks:
"""


def run(steps: str, body: Body, *, n: int = 1, start: np.ndarray | None = None) -> list[Recording]:
    spec, document = task_from_text(TASK + steps)
    return list(run_task(bind_task(spec, body, document), n=n, start=start))


def verdicts(recording: Recording) -> dict[str, bool]:
    return {v.subtask.name: v.success for v in judge(recording).verdicts}


def test_the_example_does_what_it_says(body: Body) -> None:
    spec, document = load_task(ROOT / "examples" / "05_look_and_follow.yaml")
    (recording,) = run_task(bind_task(spec, body, document))
    found = judge(recording, spec)
    assert found.success, [v.as_dict() for v in found.verdicts if not v.success]


# --- equations ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "primitive",
    [
        LookAt(at={"hand": "right_arm"}, damping=0),
        LookAt(at={"point": (0.5, 0.6, 0.4)}, joints=("waist", "neck"), damping=0),
        PointAt(limb="left_arm", at={"point": (0.5, 0.6, 0.4)}, damping=0),
    ],
    ids=("gaze", "gaze-with-waist", "pointing"),
)
def test_the_pull_is_the_gradient_of_an_energy(body: Body, primitive) -> None:
    """Curl-free: the torques' derivatives by the joint angles are symmetric."""
    trial, h = Trial(primitive, body), 1e-6
    q = trial.postures(1)
    free = np.flatnonzero(trial.free(trial.bind()))
    steps = np.vstack([q + h * np.eye(body.nv)[free], q - h * np.eye(body.nv)[free]])
    torque = trial.begun(trial.state(steps)).torque(trial.state(steps), np.full(len(steps), LATE))
    half = len(free)
    slope = (torque[:half] - torque[half:])[:, free] / (2 * h)
    assert np.abs(slope).max() > 1.0
    np.testing.assert_allclose(slope, slope.T, atol=1e-4 * np.abs(slope).max())


def test_hold_is_a_servo_to_where_it_began(body: Body) -> None:
    trial, k, kd = Trial(Hold(limb="left_arm", stiffness=40, damping=3), body), 40.0, 3.0
    began, now = trial.postures(3), trial.postures(3)[::-1].copy()
    v = trial.velocities(3)
    field, later = trial.begun(trial.state(began)), trial.state(now, v)
    torque = field.torque(later, np.array([0.0, 0.3, LATE]))[:, field.claims]
    off = (began - now)[:, field.claims]
    np.testing.assert_allclose(torque, k * off - kd * v[:, field.claims], atol=1e-9)
    np.testing.assert_allclose(field.error(later), np.abs(off).max(axis=1))


def test_a_followed_trajectory_is_the_clamped_spline(body: Body) -> None:
    rng = np.random.default_rng(0)
    times = np.cumsum(rng.uniform(0.1, 0.5, 9))
    points = [0.35, -0.2, 0.3] + 0.1 * rng.normal(size=(9, 3))
    follow = Follow(limb="right_arm", trajectory=Trajectory(times=times, points=points))
    trial = Trial(follow, body)
    state = trial.state(trial.postures(1))
    field = trial.begun(state)
    arm = body.arm("right_arm")
    axes = state.xmat[0, arm.hand].reshape(3, 3)
    palm = state.xpos[0, arm.hand] + axes @ arm.palm.point
    trunk = state.xmat[0, arm.root].reshape(3, 3)
    spline = CubicSpline(times, points, bc_type="clamped")
    for t in (0.0, times[0], *rng.uniform(times[0], times[-1], 12), times[-1], 20.0):
        field.torque(state, np.array([t]))
        where = state.xpos[0, arm.root] + trunk @ spline(np.clip(t, times[0], times[-1]))
        assert field.error(state)[0] == pytest.approx(np.linalg.norm(palm - where), abs=1e-9)


def test_relax_takes_no_more_than_damping_and_its_own_weight(body: Body) -> None:
    trial = Trial(Relax(limb="left_arm", damping=0.5), body)
    q, v = trial.postures(2), trial.velocities(2)
    state = trial.state(q, v)
    field = trial.begun(state)
    loose = field.torque(state, np.zeros(2))[:, field.claims]
    np.testing.assert_allclose(loose, -0.5 * v[:, field.claims])
    rest = trial.state(q)
    limp = Trial(Relax(limb="left_arm", limp=True), body).begun(rest).torque(rest, np.zeros(2))
    claims = field.claims
    np.testing.assert_allclose(limp[:, claims], -rest.qfrc_bias[:, claims], atol=1e-9)
    assert not np.delete(limp, claims, axis=1).any()


# --- physics --------------------------------------------------------------------------------


def test_a_hand_follows_the_other_hand_and_the_head_follows_both(body: Body) -> None:
    (recording,) = run(
        """
  - {name: lead, primitive: go-to-point, limb: left_arm, to: {point: [0.4, 0.1, 0.3]}}
  - {name: back, primitive: go-to-point, limb: left_arm, to: {point: [0.3, 0.3, 0.2]}, beats: 2}
  - {name: mirror, primitive: follow, limb: right_arm, after: [lead], beats: 2,
     to: {hand: left_arm, offset: [0, -0.25, 0]}}
  - {name: watch, primitive: look-at, at: {hand: left_arm}, after: [lead], beats: 2}
""",
        body,
    )
    assert all(verdicts(recording).values()), verdicts(recording)


def test_the_judge_sees_what_was_not_done(body: Body) -> None:
    (recording,) = run(
        """
  - {name: behind, primitive: look-at, at: {point: [-1, 0.1, 0.4]}}
  - {name: brief, primitive: point-at, limb: left_arm, at: {point: [1, 1, 0.5]}, seconds: 0.08}
  - {name: loose, primitive: relax, limb: right_arm, limp: true, seconds: 0.3, after: [raise]}
  - {name: raise, primitive: get-posture, limb: right_arm, after: [],
     posture: {arm: right, palm: down}}
  - {name: yield, primitive: hold, limb: left_arm, stiffness: 0.1, after: [brief]}
  - {name: far, primitive: follow, limb: right_arm, after: [loose],
     trajectory: {times: [0, 1], points: [[2, 0, 0], [2, 0, 1]]}}
""",
        body,
    )
    found = verdicts(recording)
    assert found.pop("raise")
    assert not any(found.values()), found


def test_a_relaxed_arm_floats_and_a_limp_one_falls(body: Body) -> None:
    moved = {}
    for limp in ("false", "true"):
        (recording,) = run(
            f"""
  - {{name: raise, primitive: get-posture, limb: left_arm, posture: {{arm: forward, palm: down}}}}
  - {{name: let-go, primitive: relax, limb: left_arm, limp: {limp}, beats: 3}}
""",
            body,
        )
        arm = body.arm("left_arm").dofs
        start, end = recording.row(1.2), recording.row(4.0)
        turned = recording.qpos[end, arm] - recording.qpos[start, arm]
        moved[limp] = float(np.rad2deg(np.abs(turned).max()))
        assert np.abs(recording.qvel[end, arm]).max() < 0.5
    assert moved["false"] < 20.0
    assert moved["true"] > 60.0


def test_reached_is_when_it_is_reached(body: Body) -> None:
    (recording,) = run(
        """
  - {name: look, primitive: look-at, at: {point: [0.5, 0.4, 0.3]}, seconds: 0.1, settle: 1,
     done: reached, tolerance: 0.03, timeout: 3}
  - {name: catch, primitive: follow, limb: left_arm, seconds: 0.1, done: reached, tolerance: 0.02,
     timeout: 5, trajectory: {times: [0, 2], points: [[0.3, 0.4, 0.2], [0.4, 0.1, 0.3]]}}
  - {name: stay, primitive: hold, limb: left_arm, seconds: 0.2, done: reached, tolerance: 0.1,
     timeout: 2}
""",
        body,
    )
    assert [s.outcome for s in recording.spans] == ["done"] * 3
    assert recording.spans[1].end - recording.spans[1].start > 0.1


def test_in_a_batch_each_does_what_it_does_alone(body: Body) -> None:
    steps = """
  - {name: point, primitive: point-at, limb: left_arm, at: {hand: right_arm}, seconds: 0.3}
  - {name: watch, primitive: look-at, at: {hand: left_arm}, after: [], seconds: 0.4}
  - {name: follow, primitive: follow, limb: right_arm, after: [], seconds: 0.3,
     trajectory: {times: [0, 0.3], points: [[0.4, -0.3, 0.2], [0.4, -0.2, 0.3]]}}
  - {name: drop, primitive: relax, limb: left_arm, limp: true, seconds: 0.2, after: [point]}
  - {name: stay, primitive: hold, limb: right_arm, after: [follow], seconds: 0.2}
"""
    start = np.tile(body.home, (3, 1))
    start[:, body.arm("left_arm").dofs] += np.array([[0.0], [0.1], [0.2]])
    together = run(steps, body, n=3, start=start)
    for k, recording in enumerate(together):
        (alone,) = run(steps, body, start=start[k])
        np.testing.assert_array_equal(alone.qpos, recording.qpos)
        np.testing.assert_array_equal(alone.torque, recording.torque)


# --- what makes no sense --------------------------------------------------------------------


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: LookAt(at="moon"), "unknown landmark"),
        (lambda: LookAt(at={"hand": "tail"}), "unknown limb"),
        (lambda: LookAt(at="head.front"), "carries that along"),
        (lambda: LookAt(at={"hand": "left_arm"}, joints=("waist", "neck")), "waist_z, which it"),
        (lambda: LookAt(at="left_hip", joints=("left_arm",)), "does not turn the head"),
        (lambda: LookAt(at="left_hip", joints=()), "leave it out"),
        (lambda: PointAt(limb="left_arm", at={"hand": "left_arm"}), "cannot be aimed"),
        (lambda: Follow(limb="left_arm", to="left_elbow.inside"), "carries that along"),
    ],
)
def test_what_does_not_fit_the_body_is_refused_when_it_is_bound(body: Body, make, said) -> None:
    with pytest.raises((PrimitiveError, BodyError), match=said):
        make().bind(body, 0.6)


def test_a_body_without_a_head_says_so() -> None:
    with pytest.raises(BodyError, match="has no head"):
        LookAt(at={"point": (1, 0, 0)}).bind(planar_arm(), 1.0)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: LookAt(at={"near": "head.top", "hand": "left_arm"}), "give one of"),
        (lambda: LookAt(at={"point": (1, 0, 0), "away": 0.1}), "no surface"),
        (Hold, "either limb or joints"),
        (lambda: Relax(limb="left_arm", joints=("neck",)), "either limb or joints"),
        (lambda: Follow(limb="left_arm"), "either to or trajectory"),
        (lambda: Trajectory(times=[0, 1, 2], points=[[0, 0, 0]] * 2), "one time for each point"),
        (lambda: Trajectory(times=[0, 1, 1], points=[[0, 0, 0]] * 3), "rise: 1 s is after 1 s"),
        (lambda: Trajectory(times=[-1, 1], points=[[0, 0, 0]] * 2), "begin at 0 s"),
    ],
)
def test_parameters_that_contradict_each_other_are_refused(make, said) -> None:
    with pytest.raises(ValidationError, match=said):
        make()


def test_a_limb_is_not_limp_twice(body: Body) -> None:
    text = "{task: t, subtasks: [{name: drop, primitive: relax, limb: left_arm, limp: true}]}"
    spec, document = task_from_text(text)
    with pytest.raises(SpecError, match="nothing in the background does: leave it out"):
        bind_task(spec, body, document)
