"""Ways of a hand: what bars the straight one, and whether the one found is free."""

import mujoco
import numpy as np
import pytest

from sim import Body, PalmGoal, Spot, adonis, find_way, straight_way
from sim.way import NEAR


@pytest.fixture(scope="module")
def body() -> Body:
    return adonis()


def onto(body: Body, landmark: str) -> PalmGoal:
    spot = body.landmark(landmark)
    return PalmGoal(spot, normal=body.from_link(spot.link, -spot.normal), touched=spot.link)


def arms_forward(body: Body) -> np.ndarray:
    q = body.home.copy()
    for side in ("right", "left"):
        q[body.qpos_of_dof[body.joints(f"{side}_shoulder_y")]] = np.pi / 2
        q[body.qpos_of_dof[body.joints(f"{side}_elbow")]] = 0.0
    return q


def test_a_straight_way_through_the_air_is_free(body: Body) -> None:
    arm = body.arm("right_arm")
    goal = PalmGoal(Spot(arm.root, np.array([0.40, -0.25, 0.25]), np.zeros(3)))
    way = straight_way(body, arms_forward(body), arm, goal)
    assert way.free
    assert way.stray < 0.005
    bends = np.cross(np.diff(way.path, axis=0), way.path[-1] - way.path[0])
    assert np.abs(bends).max() < 1e-9
    assert find_way(body, arms_forward(body), arm, goal).via == ()


def test_what_bars_a_straight_way_is_named(body: Body) -> None:
    way = straight_way(body, body.home, body.arm("right_arm"), onto(body, "left_ribs"))
    assert not way.free
    assert way.clearance < -0.05
    assert way.tight > 0.05
    assert way.links[0] in ("right_forearm", "right_hand")
    assert way.links[1] == "trunk"


def test_the_other_arm_can_be_in_the_way(body: Body) -> None:
    """Both arms forward; the right hand is to go to the far side of the left forearm."""
    arm = body.arm("right_arm")
    goal = PalmGoal(Spot(arm.root, np.array([0.40, 0.40, 0.36]), np.zeros(3)))
    way = straight_way(body, arms_forward(body), arm, goal)
    assert not way.free
    assert way.links[1].startswith("left_")


@pytest.mark.parametrize(
    ("limb", "landmark"), [("right_arm", "head.back_right"), ("left_arm", "right_ribs")]
)
def test_the_way_found_goes_through_nothing(body: Body, limb: str, landmark: str) -> None:
    """MuJoCo's own collision detection is asked, with every geom of the model."""
    arm, goal = body.arm(limb), onto(body, landmark)
    start = arms_forward(body)
    detour = find_way(body, start, arm, goal)
    assert 1 <= len(detour.via) <= 2
    assert detour.way.free
    data = mujoco.MjData(body.model)
    for palm, q in zip(detour.way.path, detour.way.postures, strict=True):
        data.qpos[:] = q
        mujoco.mj_fwdPosition(body.model, data)
        deepest = min((c.dist for c in data.contact), default=0.0)
        touching = np.linalg.norm(palm - detour.way.path[-1]) < NEAR
        assert deepest > (-0.02 if touching else -0.005)
    others = np.setdiff1d(np.arange(body.nv), arm.dofs)
    moved = np.ptp(detour.way.postures[:, body.qpos_of_dof], axis=0)
    assert moved[others].max() < 1e-6
    low, high = body.range
    angles = detour.way.postures[:, body.qpos_of_dof]
    assert (angles > low - 1e-3).all()
    assert (angles < high + 1e-3).all()


def test_the_same_question_gets_the_same_answer(body: Body) -> None:
    arm, goal = body.arm("right_arm"), onto(body, "right_shoulder.top")
    one, other = (find_way(body, body.home, arm, goal, counts=(1,)) for _ in range(2))
    np.testing.assert_array_equal(one.via[0], other.via[0])
    np.testing.assert_array_equal(one.way.postures, other.way.postures)


def test_a_wish_for_the_upper_arm_is_kept(body: Body) -> None:
    arm, wish = body.arm("right_arm"), np.array([0.0, -1.0, 0.0])
    spot = body.landmark("chest.front")
    goal = PalmGoal(spot, upper_arm=wish, touched=spot.link)
    found = find_way(body, body.home, arm, goal, counts=(1,))
    np.testing.assert_allclose(found.upper_arm, wish)


def test_an_arm_that_cannot_go_there_strays(body: Body) -> None:
    arm = body.arm("right_arm")
    goal = PalmGoal(Spot(arm.root, np.array([1.5, 0.0, 0.3]), np.zeros(3)))
    way = straight_way(body, body.home, arm, goal)
    assert way.stray > 0.5
    assert not way.free
