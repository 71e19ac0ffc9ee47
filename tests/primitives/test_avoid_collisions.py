"""avoid-collisions: real distances, repulsion before contact, a gradient, and a way in."""

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from primitives import AvoidCollisions, CompensateGravity
from primitives.repulsion import closest_on_segments
from sim import Body, World

coordinate = st.floats(-0.5, 0.5)
point = st.tuples(coordinate, coordinate, coordinate)


@given(point, point, point, point)
def test_no_other_points_of_the_segments_are_closer(a0, a1, b0, b1) -> None:
    middles = 0.5 * np.add(a0, a1), 0.5 * np.add(b0, b1)
    u, v, w = 0.5 * np.subtract(a1, a0), 0.5 * np.subtract(b1, b0), middles[0] - middles[1]
    along, across = closest_on_segments(tuple(u), u @ u, tuple(v), v @ v, tuple(w))
    assert max(abs(along), abs(across)) <= 1.0
    nearest = np.linalg.norm(w + along * u - across * v)
    s = np.linspace(0, 1, 41)[:, None]
    on_a = np.array(a0) + s * np.subtract(a1, a0)
    on_b = np.array(b0) + s * np.subtract(b1, b0)
    every = np.linalg.norm(on_a[:, None] - on_b[None], axis=2)
    assert nearest <= every.min() + 1e-9


@settings(max_examples=25)
@given(st.integers(0, 10_000))
def test_distances_are_those_of_mujoco(body: Body, seed: int) -> None:
    """Repulsion is zero exactly when MuJoCo sees every pair out of range."""
    rng = np.random.default_rng(seed)
    low, high = body.range
    q = rng.uniform(low, high)
    data = mujoco.MjData(body.model)
    data.qpos[:] = q
    mujoco.mj_kinematics(body.model, data)
    model, nearest = body.model, np.inf
    for one, other in body.map.keep_apart:
        for a in np.flatnonzero(model.geom_bodyid == body.link(one)):
            for b in np.flatnonzero(model.geom_bodyid == body.link(other)):
                if model.geom_contype[a] and model.geom_contype[b]:
                    d = mujoco.mj_geomDistance(model, data, a, b, 1.0, None)
                    nearest = min(nearest, d)
    reach = 0.05
    world = World(body)
    world.reset(q)
    field = AvoidCollisions(range=reach).bind(body, np.inf)
    torque = field.torque(world.state, np.zeros(1))
    assert (np.abs(torque).max() > 0) == (nearest < reach)


def arms_crossing(body: Body, angle: float) -> np.ndarray:
    """Both arms forward and turned inwards by an angle [deg]."""
    q = body.home.copy()
    for side in ("left", "right"):
        q[body.joints(f"{side}_shoulder_y")] = np.deg2rad(90)
        q[body.joints(f"{side}_shoulder_x")] = np.deg2rad(-angle)
    return q


def test_it_pushes_before_contact_and_harder_when_closer(body: Body) -> None:
    field = AvoidCollisions(range=0.05).bind(body, np.inf)
    postures = [arms_crossing(body, a) for a in np.linspace(5, 20, 100)]
    postures = [q for q in postures if body.is_free(q)]
    world = World(body, len(postures))
    world.reset(np.array(postures))
    push = np.abs(field.torque(world.state, np.zeros(len(postures)))).max(axis=1)
    assert push[0] == 0.0
    assert push[-1] > 10.0
    assert (np.diff(push[push > 0]) > 0).all()


def test_at_rest_it_is_the_gradient_of_a_potential(body: Body) -> None:
    """Its curl is zero: no work is gained around a small loop."""
    field = AvoidCollisions(range=0.06).bind(body, np.inf)
    world = World(body)

    def torque(q: np.ndarray) -> np.ndarray:
        world.reset(q)
        return field.torque(world.state, np.zeros(1))[0].copy()

    rng, h, tested = np.random.default_rng(3), 1e-6, 0
    low, high = body.range
    while tested < 10:
        q = rng.uniform(low, high)
        if not body.is_free(q) or np.abs(torque(q)).max() < 0.1:
            continue
        u, v = rng.normal(0, 1, (2, body.nv))
        around = (torque(q + h * u) - torque(q - h * u)) @ v / (2 * h)
        across = (torque(q + h * v) - torque(q - h * v)) @ u / (2 * h)
        assert around == pytest.approx(across, rel=1e-3, abs=1e-3)
        tested += 1


def test_arms_that_are_driven_together_do_not_meet(body: Body) -> None:
    world = World(body)
    world.reset(arms_crossing(body, 0.0))
    guard = AvoidCollisions(range=0.05, stiffness=1500.0).bind(body, np.inf)
    weight = CompensateGravity().bind(body, np.inf)
    drive = np.zeros((1, body.nv))
    drive[:, body.joints(["left_shoulder_x", "right_shoulder_x"])] = -6.0
    hold = np.zeros(body.nv)
    hold[body.joints(["waist", "neck"])] = 300.0
    still = np.zeros(1)
    for _ in range(800):
        s = world.state
        posture = hold * (body.home - s.qpos) - 8.0 * s.qvel
        world.step(drive + guard.torque(s, still) + weight.torque(s, still) + posture)
        assert body.is_free(s.qpos[0])


def test_its_pairs_are_those_of_the_body_unless_told(body: Body) -> None:
    q = arms_crossing(body, 18.0)[None]
    world = World(body)
    world.reset(q)
    other = AvoidCollisions(pairs=[("left_hand", "head")], range=0.05).bind(body, np.inf)
    assert np.abs(other.torque(world.state, np.zeros(1))).max() == 0.0


def test_a_touch_is_let_through_whichever_link_is_named_first() -> None:
    from primitives.repulsion import let_through
    from primitives.table import TOUCH

    touches = np.zeros(1, dtype=TOUCH)
    touches["hand"], touches["link"], touches["share"] = 3, 7, 0.4
    assert let_through(touches, 3, 7) == let_through(touches, 7, 3) == pytest.approx(0.6)
    assert let_through(touches, 3, 6) == 1.0
