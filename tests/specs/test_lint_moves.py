"""What is foreseen of a movement agrees with the simulation of it."""

from typing import Any

import numpy as np
import pytest

from adonis.dancing import run_task
from primitives import CompensateGravity, GetPosture, GoToPoint, Place, Primitive
from sim import Body, Recording, clearances, places_of, planar_arm
from specs import Background, BoundTask, SubTask, TaskSpec, bind_task
from specs.lint.course import planned_moves
from specs.lint.move import Move

RAISED: dict[str, Any] = {
    "right_shoulder_y": 80.0, "right_shoulder_x": 30.0, "right_shoulder_z": 10.0,
    "right_elbow": 60.0, "right_wrist_z": 20.0, "right_wrist_x": 10.0, "right_wrist_y": 0.0,
}  # fmt: skip
FREE = GoToPoint(limb="right_arm", to=Place(point=(0.4, -0.3, 0.35)))
ACROSS = GoToPoint(limb="right_arm", to=Place(near="left_ribs", away=0.09))
FLEXED = {**RAISED, "right_shoulder_y": 0.0, "right_elbow": 149.0}
# The arm leans on the ribs: its upper arm is to go into them.
PRESSED = {**RAISED, "right_shoulder_y": 35.0, "right_shoulder_x": -28.0}


def task(body: Body, does: Primitive, seconds: float) -> BoundTask:
    upright = GetPosture(joints=("waist", "neck"), posture="upright")
    rest = GetPosture(joints=("right_arm", "left_arm"), posture="rest")
    beside = (
        Background(name="upright", does=upright),
        Background(name="arms", does=rest),
        Background(name="weight", does=CompensateGravity()),
    )
    step = SubTask(name="go", does=does, seconds=seconds)
    return bind_task(TaskSpec(task="t", background=beside, subtasks=(step,)), body)


def foreseen_and_done(body: Body, does: Primitive, seconds: float) -> tuple[Move, Recording]:
    made = task(body, does, seconds)
    (move,) = planned_moves(made)
    (recording,) = run_task(made, contributions=False)
    return move, recording


def off(body: Body, move: Move, recording: Recording) -> float:
    """How far any joint is from where it was foreseen, ever [deg]."""
    columns = body.qpos_of_dof[move.dofs]
    times = np.arange(0.0, move.duration + move.hold, 0.01)
    gaps = [
        np.abs(move.foreseen.at(float(t)) - recording.qpos[recording.row(float(t))])[columns].max()
        for t in times
    ]
    return float(np.rad2deg(max(gaps)))


@pytest.mark.parametrize(
    ("does", "seconds", "within"),
    [
        (GetPosture(limb="right_arm", posture=RAISED), 0.8, 0.5),
        (GetPosture(limb="right_arm", posture=RAISED), 0.3, 0.5),
        (GetPosture(limb="right_arm", posture=RAISED), 0.12, 3.0),  # at the motors' limits
        (GetPosture(joints=("right_elbow",), posture={"right_elbow": 90}), 0.4, 0.5),
        (GetPosture(limb="right_arm", posture=FLEXED), 0.3, 1.0),  # past an end, which gives
        (GetPosture(limb="right_arm", posture=PRESSED), 0.6, 1.5),  # against the ribs
        (FREE, 1.0, 1.0),
        (FREE, 0.3, 2.0),
    ],
)
def test_angles_and_speeds_are_foreseen(
    body: Body, does: Primitive, seconds: float, within: float
) -> None:
    move, recording = foreseen_and_done(body, does, seconds)
    assert off(body, move, recording) < within  # [deg]
    fastest = np.abs(recording.qvel[:, move.dofs]).max(axis=0) / body.speed_limit[move.dofs]
    foreseen = move.foreseen.speed[: len(move.dofs)]
    assert foreseen.max() == pytest.approx(fastest.max(), rel=0.05)


def test_what_is_leant_on_is_foreseen_with_what_slides_along_it(body: Body) -> None:
    move, recording = foreseen_and_done(body, ACROSS, 1.0)
    assert off(body, move, recording) < 10.0  # [deg], though the forearm rubs along the ribs
    end = recording.row(move.duration + move.hold)
    assert move.missed(move.foreseen, move.duration) < 1.0
    palm, there = (
        places_of(body, q, [move.body.arm("right_arm").palm])[0]
        for q in (move.foreseen.qpos[-1], recording.qpos[end])
    )
    np.testing.assert_allclose(palm, there, atol=0.003)
    forearm = [("right_forearm", "trunk")]
    deepest, done, through = (
        -float(clearances(body, q, forearm).min())
        for q in (move.foreseen.qpos, recording.qpos, move.through().qpos)
    )
    assert 0.0 < deepest == pytest.approx(done, abs=0.003)
    assert through > 0.05  # [m]


def test_the_start_of_a_task_is_foreseen_while_the_background_settles(body: Body) -> None:
    made = task(body, FREE, 0.6)
    made.start[body.qpos_of_dof[body.joints("right_arm")]] = np.deg2rad(list(RAISED.values()))
    (move,) = planned_moves(made)
    (recording,) = run_task(made, contributions=False)
    assert off(body, move, recording) < 1.0  # [deg]


def test_a_long_time_takes_longer_steps_and_ends_alike(body: Body) -> None:
    (move,) = planned_moves(task(body, FREE, 1.0))
    slow = move.in_time(8.0)
    assert slow.time[1] > 1.5 * move.foreseen.time[1]
    arm = body.arm("right_arm")
    ends = [places_of(body, q[-1], [arm.palm])[0] for q in (slow.qpos, move.foreseen.qpos)]
    np.testing.assert_allclose(*ends, atol=2e-3)


def test_postures_between_two_times_have_both_ends(body: Body) -> None:
    (move,) = planned_moves(task(body, FREE, 1.0))
    seen = move.foreseen
    half = 0.5 * (seen.time[3] + seen.time[4])
    held = seen.between(half, float(seen.time[8]))
    np.testing.assert_allclose(held[0], 0.5 * (seen.qpos[3] + seen.qpos[4]), atol=1e-12)
    np.testing.assert_array_equal(held[1:], seen.qpos[[*range(4, 8), 8]])
    np.testing.assert_array_equal(seen.at(99.0), seen.qpos[-1])


def test_success_is_what_the_judge_measures(body: Body) -> None:
    """The same numbers as the judge's, taken from what is foreseen instead of a recording."""
    from adonis.judging import judge

    for does, seconds in ((FREE, 0.4), (GetPosture(limb="right_arm", posture=RAISED), 0.2)):
        made = task(body, does, seconds)
        (move,) = planned_moves(made)
        (recording,) = run_task(made, contributions=False)
        (verdict,) = judge(recording, made.spec).verdicts
        worst = max(m.value / m.limit for m in verdict.measures)
        assert move.missed(move.foreseen, seconds) == pytest.approx(worst, rel=0.05, abs=0.05)


def test_a_body_without_limbs_is_foreseen_too() -> None:
    arm = planar_arm()
    step = SubTask(name="go", does=GetPosture(joints=("arm",), posture="rest"), seconds=0.5)
    made = bind_task(TaskSpec(task="t", subtasks=(step,)), arm)
    made.start[:] = np.deg2rad((10.0, 20.0))
    (move,) = planned_moves(made)
    (recording,) = run_task(made, contributions=False)
    assert off(arm, move, recording) < 0.5  # [deg]
