"""What is foreseen of a way agrees with the simulation of it."""

import numpy as np
import pytest

from adonis.dancing import run_task
from primitives import CompensateGravity, GetPosture, GoToPoint, Place, Primitive
from sim import Body, axes_of, clearance, clearances, depth_inside, origin, places_of, turned
from specs import Background, BoundTask, SubTask, TaskSpec, bind_task
from specs.lint.course import planned_moves

RAISED: dict[str, float | str | tuple[float, float, float]] = {
    "right_shoulder_y": 80.0, "right_shoulder_x": 30.0, "right_shoulder_z": 10.0,
    "right_elbow": 60.0, "right_wrist_z": 20.0, "right_wrist_x": 10.0, "right_wrist_y": 0.0,
}  # fmt: skip


def task(body: Body, does: Primitive, seconds: float) -> BoundTask:
    upright = GetPosture(joints=("waist", "neck"), posture="upright")
    beside = (
        Background(name="upright", does=upright),
        Background(name="weight", does=CompensateGravity()),
    )
    step = SubTask(name="go", does=does, seconds=seconds)
    return bind_task(TaskSpec(task="t", background=beside, subtasks=(step,)), body)


@pytest.mark.parametrize("seconds", [0.3, 0.5, 0.8])
def test_the_lag_of_a_posture_is_foreseen(body: Body, seconds: float) -> None:
    made = task(body, GetPosture(limb="right_arm", posture=RAISED), seconds)
    (move,) = planned_moves(made)
    assert move.haste is not None
    lag = move.haste.in_time(seconds, seconds, move.hold, move.hand_over)
    (recording,) = run_task(made, contributions=False)
    columns = body.qpos_of_dof[move.dofs]
    off = (move.way[-1] - recording.qpos[recording.row(seconds)])[columns]
    np.testing.assert_allclose(lag.off[0], off, atol=np.deg2rad(2.0) + 0.15 * np.abs(off).max())
    fastest = np.abs(recording.qvel[:, move.dofs]).max(axis=0) / body.speed_limit[move.dofs]
    assert lag.speed.max() == pytest.approx(fastest.max(), rel=0.1)
    assert not lag.lost


def test_the_way_of_a_hand_is_foreseen_to_the_elbow(body: Body) -> None:
    does = GoToPoint(limb="right_arm", to=Place(point=(0.4, -0.3, 0.35)))
    made = task(body, does, 1.0)
    (move,) = planned_moves(made)
    assert move.short < 1e-3
    (recording,) = run_task(made, contributions=False)
    arm = body.arm("right_arm")
    shares = np.linspace(0.0, move.travel, len(move.way))
    for share, foreseen in zip(shares[::8], move.way[::8], strict=True):
        there = recording.qpos[recording.row(float(share))]
        spots = [arm.palm, origin(arm.forearm)]
        gap = np.linalg.norm(
            places_of(body, foreseen, spots) - places_of(body, there, spots), axis=1
        )
        assert gap.max() < 0.05  # [m] the hand lags, the elbow follows it


def test_depth_and_clearance_of_the_same_place_agree(body: Body) -> None:
    mark = body.landmark("chest.front")
    for inside in (0.01, 0.03):
        point = body.at_home(mark.link, mark.point - inside * mark.normal)
        depth, link = depth_inside(body, body.home, point, ["head", "trunk"])
        assert link == "trunk"
        assert depth == pytest.approx(inside, abs=1e-3)
    outside = body.at_home(mark.link, mark.point + 0.01 * mark.normal)
    assert depth_inside(body, body.home, outside, ["head", "trunk"]) == (0.0, "")
    pairs = body.map.keep_apart
    least = clearances(body, body.home[None], pairs).min()
    assert least == pytest.approx(clearance(body, body.home), abs=1e-9)


def test_a_direction_turns_on_the_great_circle(body: Body) -> None:
    x, y, _ = axes_of(body, body.home, 0)
    np.testing.assert_allclose(turned(x, y, 0.5), (x + y) / np.sqrt(2.0), atol=1e-12)
    np.testing.assert_allclose(turned(x, -x, 1.0), -x, atol=1e-2)
    assert np.linalg.norm(turned(x, -x, 0.3)) == pytest.approx(1.0)
