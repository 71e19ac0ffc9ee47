"""What every field of ours must do, and what each of them is for."""

import mujoco
import numpy as np
import pytest

from primitives import AvoidCollisions, CompensateGravity, GetPosture, GoToPoint, PrimitiveError
from primitives.impedance import PALM_WAITS
from sim import Body, BodyError, State, World

OUT = {"arm": "forward", "elbow": "straight", "palm": "down"}
LONG = 10.0  # [s] by then every set point has arrived


def state_at(body: Body, qpos: np.ndarray, qvel: np.ndarray | None = None) -> State:
    """States of (n, nq) postures and (n, nv) velocities."""
    world = World(body, len(qpos))
    world.reset(qpos, qvel)
    return world.state


def some(body: Body, n: int, seed: int = 0) -> np.ndarray:
    """Postures around home."""
    rng = np.random.default_rng(seed)
    low, high = body.range
    return np.clip(body.home + rng.normal(0, 0.3, (n, body.nv)), low + 0.05, high - 0.05)


ALL = [
    GetPosture(limb="right_arm", posture=OUT),
    GetPosture(joints=("waist", "neck"), posture="upright"),
    GoToPoint(limb="left_arm", to="head.back", upper_arm="left"),
    GoToPoint(limb="right_arm", to={"point": (0.4, -0.1, 0.3)}, palm="down", fingers="forward"),
    AvoidCollisions(),
    CompensateGravity(),
]
MOVING = [p for p in ALL if isinstance(p, GetPosture | GoToPoint)]


@pytest.mark.parametrize("primitive", ALL, ids=lambda p: p.kind)
def test_torques_are_finite_and_the_same_alone_as_in_a_batch(body: Body, primitive) -> None:
    q = some(body, 4)
    v = np.random.default_rng(1).normal(0, 1, (4, body.nv))
    t = np.array([0.0, 0.1, 0.3, 2.0])
    together = primitive.bind(body, 0.6)
    state = state_at(body, q, v)
    together.begin(state, np.ones(4, dtype=bool))
    whole = together.torque(state, t)
    assert whole.shape == (4, body.nv)
    assert np.isfinite(whole).all()
    for k in range(4):
        alone = primitive.bind(body, 0.6)
        one = state_at(body, q[k : k + 1], v[k : k + 1])
        alone.begin(one, np.ones(1, dtype=bool))
        np.testing.assert_array_equal(alone.torque(one, t[k : k + 1])[0], whole[k])


@pytest.mark.parametrize("primitive", MOVING, ids=lambda p: p.kind)
def test_a_movement_begins_gently_from_wherever_the_body_is(body: Body, primitive) -> None:
    state = state_at(body, some(body, 3))
    field = primitive.bind(body, 0.6)
    field.begin(state, np.ones(3, dtype=bool))
    torque = np.abs(field.torque(state, np.zeros(3)))
    asked = np.abs(field.torque(state, np.full(3, LONG)))
    assert torque.max() < 1.0
    assert asked.max() > 5.0


@pytest.mark.parametrize("primitive", MOVING, ids=lambda p: p.kind)
def test_it_wants_only_the_joints_it_claims(body: Body, primitive) -> None:
    field = primitive.bind(body, 0.6)
    state = state_at(body, some(body, 2), np.ones((2, body.nv)))
    field.begin(state, np.ones(2, dtype=bool))
    torque = field.torque(state, np.full(2, LONG))
    np.testing.assert_array_equal(np.delete(torque, field.claims, axis=1), 0.0)


def test_get_posture_is_equation_1(body: Body) -> None:
    k, kd = 30.0, 4.0
    field = GetPosture(limb="right_arm", posture=OUT, stiffness=k, damping=kd).bind(body, 0.6)
    q, v = some(body, 2), np.random.default_rng(2).normal(0, 1, (2, body.nv))
    state = state_at(body, q, v)
    field.begin(state, np.ones(2, dtype=bool))
    arm = field.claims
    torque = field.torque(state, np.full(2, LONG))[:, arm]
    np.testing.assert_allclose(torque, k * (field.goal - q)[:, arm] - kd * v[:, arm], atol=1e-9)
    halfway = field.torque(state, np.full(2, 0.3))[:, arm]
    middle, speed = 0.5 * (q + field.goal), 1.5 * (field.goal - q) / 0.6
    expected = k * (middle - q)[:, arm] + kd * (speed - v)[:, arm]
    np.testing.assert_allclose(halfway, expected, atol=1e-9)


def test_get_posture_passes_its_via_postures(body: Body) -> None:
    via = [{"posture": {"arm": "forward", "palm": "up", "elbow": 90.0}, "at": 0.4}]
    through = GetPosture(limb="left_arm", posture=OUT, via=via, damping=0.0).bind(body, 1.0)
    state = state_at(body, some(body, 1))
    through.begin(state, np.ones(1, dtype=bool))
    there = GetPosture(limb="left_arm", posture=via[0]["posture"], damping=0.0).bind(body, 1.0)
    there.begin(state, np.ones(1, dtype=bool))
    np.testing.assert_allclose(
        through.torque(state, np.array([0.4])), there.torque(state, np.array([LONG])), atol=1e-6
    )


def test_at_its_goal_and_at_rest_a_posture_asks_for_nothing(body: Body) -> None:
    field = GetPosture(limb="right_arm", posture=OUT).bind(body, 0.6)
    q = body.home.copy()
    q[field.claims] = field.goal[field.claims]
    state = state_at(body, q[None])
    field.begin(state, np.ones(1, dtype=bool))
    np.testing.assert_allclose(field.torque(state, np.array([LONG])), 0.0, atol=1e-9)
    assert field.error(state)[0] == pytest.approx(0.0, abs=1e-9)


def test_the_hand_spring_is_the_gradient_of_its_energy(body: Body) -> None:
    """J^T K (x_d - x) = - d/dq of K |x_d - x|^2 / 2 (eq 7 and 8)."""
    stiffness = 200.0
    place = {"point": (0.35, 0.1, 0.35)}
    quiet = {"turn_stiffness": 1e-12, "turn_damping": 0, "shoulder_damping": 0, "damping": 0}
    reach = GoToPoint(limb="right_arm", to=place, stiffness=stiffness, **quiet)
    q = some(body, 1)

    def field_at(qpos: np.ndarray):
        field = reach.bind(body, 0.6)
        state = state_at(body, qpos)
        field.begin(state, np.ones(1, dtype=bool))
        return field, state

    def energy(qpos: np.ndarray) -> float:
        field, state = field_at(qpos)
        return 0.5 * stiffness * field.error(state)[0] ** 2

    field, state = field_at(q)
    torque = field.torque(state, np.array([LONG]))[0]
    h = 1e-6
    for dof in field.claims:
        step = h * np.eye(body.nv)[dof]
        slope = (energy(q + step) - energy(q - step)) / (2 * h)
        assert torque[dof] == pytest.approx(-slope, abs=1e-4)


def test_the_upper_arm_spring_only_turns_the_shoulder(body: Body) -> None:
    common = {"limb": "left_arm", "to": {"point": (0.3, 0.2, 0.3)}}
    state = state_at(body, some(body, 1))
    torques = []
    for extra in ({}, {"upper_arm": "forward"}):
        field = GoToPoint(**common, **extra).bind(body, 0.6)
        field.begin(state, np.ones(1, dtype=bool))
        torques.append(field.torque(state, np.array([LONG]))[0])
    changed = np.flatnonzero(np.abs(torques[1] - torques[0]) > 1e-9)
    assert len(changed) > 0
    assert set(changed) <= set(body.arm("left_arm").shoulder_dofs)


def test_the_palm_keeps_its_place_on_the_forearm_at_first(body: Body) -> None:
    """Early in a reach nothing turns the wrist, however the palm is to face in the end."""
    strong = {"turn_stiffness": 50.0, "turn_damping": 0, "stiffness": 1e-9, "damping": 0}
    reach = GoToPoint(limb="left_arm", to="head.back", shoulder_damping=0, **strong)
    field = reach.bind(body, 1.0)
    state = state_at(body, body.home[None])
    field.begin(state, np.ones(1, dtype=bool))
    early = field.torque(state, np.array([0.9 * PALM_WAITS * reach.travel]))
    late = field.torque(state, np.array([LONG]))
    assert np.abs(early).max() < 1e-6
    assert np.abs(late).max() > 1.0


@pytest.mark.parametrize("to", ["head.back", "left_hip", {"near": "chest.front", "away": 0.2}])
def test_error_is_the_distance_of_palm_and_goal(body: Body, to) -> None:
    field = GoToPoint(limb="right_arm", to=to).bind(body, 0.6)
    state = state_at(body, body.home[None])
    data = mujoco.MjData(body.model)
    data.qpos[:] = body.home
    mujoco.mj_kinematics(body.model, data)
    mark = data.site(to if isinstance(to, str) else to["near"])
    goal = mark.xpos + (0.0 if isinstance(to, str) else 0.2) * mark.xmat.reshape(3, 3)[:, 0]
    expected = np.linalg.norm(data.site("right_palm").xpos - goal)
    assert field.error(state)[0] == pytest.approx(expected)


def test_gravity_compensation_is_the_bias_torque_at_rest(body: Body) -> None:
    state = state_at(body, some(body, 5))
    field = CompensateGravity().bind(body, np.inf)
    np.testing.assert_allclose(field.torque(state, np.zeros(5)), state.qfrc_bias, atol=1e-9)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: GetPosture(limb="right_arm", posture="upright"), "says nothing about"),
        (lambda: GetPosture(limb="right_arm", posture={"knee": 3.0}), "unknown joint"),
        (lambda: GetPosture(joints=("neck",), posture={"palm": "up"}), "only a posture of a limb"),
        (lambda: GetPosture(limb="left_arm", posture={"arm": 3.0}), "takes a direction"),
        (lambda: GetPosture(limb="left_arm", posture={"elbow": "bent"}), "straight or an angle"),
        (lambda: GetPosture(limb="left_arm", posture={"wrist_x": "up"}), "angle in degrees"),
        (lambda: GoToPoint(limb="leg", to="head.back"), "unknown limb"),
        (lambda: GoToPoint(limb="left_arm", to="moon"), "unknown landmark"),
        (
            lambda: GoToPoint(
                limb="left_arm",
                to="head.back",
                via=[{"near": "head.top", "at": 0.6}, {"near": "head.left", "at": 0.4}],
            ),
            "must rise",
        ),
        (lambda: AvoidCollisions(pairs=[("left_hand", "moon")]), "unknown link"),
    ],
)
def test_what_does_not_fit_the_body_is_refused_when_it_is_bound(body: Body, make, said) -> None:
    with pytest.raises((PrimitiveError, BodyError), match=said):
        make().bind(body, 0.6)
