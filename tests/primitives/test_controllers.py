"""Controllers: each against its equation, and any of them for any sub-task."""

import mujoco
import numpy as np
import pytest

from adonis.dancing import run_task
from primitives import GetPosture, GoToPoint
from primitives.profiles import pulse, step
from sim import Body, PalmGoal, Spot, State, World, reach
from specs import SpecError, bind_task, load_variant, task_from_text

CONTROLLERS = ("pd-servo", "torque-field", "impedance", "endpoint-force")


def test_pulse_is_the_derivative_of_step() -> None:
    s = np.linspace(0.001, 0.999, 101)
    h = 1e-6
    slope = [(step(x + h) - step(x - h)) / (2 * h) for x in s]
    np.testing.assert_allclose(slope, [pulse(x) for x in s], atol=1e-6)
    assert (step(-1.0), step(0.0), step(1.0), step(2.0)) == (0.0, 0.0, 1.0, 1.0)
    assert (pulse(-0.1), pulse(1.1)) == (0.0, 0.0)


# --- torque-field -----------------------------------------------------------------------------


def well(e: np.ndarray, amplitude: float, width: float) -> np.ndarray:
    return -amplitude * e * np.exp(-(e**2) / (2 * width**2))


def elbow_states(body: Body, angles: np.ndarray) -> tuple[State, int]:
    world = World(body, len(angles))
    dof = int(body.joints("right_elbow")[0])
    q = np.tile(body.home, (len(angles), 1))
    q[:, body.qpos_of_dof[dof]] = angles
    world.reset(q)
    return world.state, dof


def elbow_field(body: Body, angles: np.ndarray, t: float, **parameters) -> np.ndarray:
    """Torque of the elbow (k,) at so many angles, t seconds after being switched on at 0.2 rad."""
    primitive = GetPosture(
        controller="torque-field", joints=("right_elbow",), posture={"right_elbow": 57.29577951},
        **parameters,
    )  # fmt: skip
    field = primitive.bind(body, 1.0)
    start, dof = elbow_states(body, np.full(len(angles), 0.2))
    field.begin(start, np.ones(len(angles), dtype=bool))
    state, _ = elbow_states(body, angles)
    return field.torque(state, np.full(len(angles), t))[:, dof]


ANGLES = np.linspace(0.0, 2.4, 25)


@pytest.mark.parametrize("t", [0.0, 0.3, 0.5, 1.0, 9.0])
def test_a_torque_field_steps_from_one_well_to_another(body: Body, t: float) -> None:
    torque = elbow_field(body, ANGLES, t, stiffness=30.0, width=0.6)
    w = step(t)
    expected = (1 - w) * well(ANGLES - 0.2, 30.0, 0.6) + w * well(ANGLES - 1.0, 30.0, 0.6)
    np.testing.assert_allclose(torque, expected, atol=1e-6)


def test_a_pulse_takes_the_well_of_a_via_posture_in_and_out(body: Body) -> None:
    via = ({"posture": {"right_elbow": 114.591559}, "at": 0.4, "pulse": 0.7},)
    torque = elbow_field(body, ANGLES, 0.25, stiffness=30.0, width=0.6, via=via)
    without = elbow_field(body, ANGLES, 0.25, stiffness=30.0, width=0.6)
    expected = 0.7 * pulse(0.25) * well(ANGLES - 2.0, 30.0, 0.6)
    np.testing.assert_allclose(torque - without, expected, atol=1e-6)


def test_a_stiffness_alone_means_the_pair_of_eq_3(body: Body) -> None:
    k = 4.0
    torque = elbow_field(body, ANGLES, 9.0, stiffness=k)
    e = ANGLES - 1.0
    np.testing.assert_allclose(torque, -k * e * np.exp(-k * e**2 / 2), atol=1e-6)
    peak = elbow_field(body, np.array([1.0 + 1 / np.sqrt(k)]), 9.0, stiffness=k)[0]
    assert peak == pytest.approx(-0.6065 * np.sqrt(k), rel=1e-3)


def test_a_coupled_well_sums_its_exponent_over_the_joints(body: Body) -> None:
    joints = ("right_elbow", "right_wrist_z")
    goal = {"right_elbow": 60, "right_wrist_z": 0}
    primitive = GetPosture(
        controller="torque-field", joints=joints, posture=goal, stiffness=20.0, width=0.8,
        damping=0.5, coupled=True,
    )  # fmt: skip
    field = primitive.bind(body, 1.0)
    world = World(body)
    rng = np.random.default_rng(3)
    q, v = body.home + rng.normal(0, 0.2, body.nv), rng.normal(0, 1, body.nv)
    world.reset(q)
    field.begin(world.state, np.ones(1, dtype=bool))
    data = mujoco.MjData(body.model)
    data.qpos[:], data.qvel[:] = q, v
    mujoco.mj_forward(body.model, data)
    torque = field.torque(State.of(data), np.array([9.0]))[0]
    dofs = body.joints(joints)
    e = q[body.qpos_of_dof[dofs]] - np.deg2rad([60, 0])
    expected = -20.0 * e * np.exp(-np.sum(e**2) / (2 * 0.8**2)) - 0.5 * v[dofs]
    np.testing.assert_allclose(torque[dofs], expected, rtol=1e-9)
    assert np.count_nonzero(torque) == 2


# --- endpoint-force ---------------------------------------------------------------------------


def test_endpoint_force_is_a_force_on_the_palm_and_damped_joints(body: Body) -> None:
    primitive = GoToPoint(
        controller="endpoint-force", limb="right_arm", to={"point": (0.4, -0.1, 0.3)},
        stiffness=200.0, damping=10.0, approach=-30.0, joint_damping=1.5,
    )  # fmt: skip
    field = primitive.bind(body, 0.5)
    data = mujoco.MjData(body.model)
    rng = np.random.default_rng(1)
    data.qpos[:], data.qvel[:] = body.home + rng.normal(0, 0.1, body.nv), rng.normal(0, 1, body.nv)
    mujoco.mj_forward(body.model, data)
    state = State.of(data)
    field.begin(state, np.ones(1, dtype=bool))
    torque = field.torque(state, np.array([5.0]))[0]
    arm = body.arm("right_arm")
    jacobian = np.zeros((3, body.nv))
    site = body.model.site("right_palm").id
    mujoco.mj_jacSite(body.model, data, jacobian, None, site)
    palm, velocity = data.site("right_palm").xpos, jacobian @ data.qvel
    trunk = data.body("trunk")
    goal = trunk.xpos + trunk.xmat.reshape(3, 3) @ np.array([0.4, -0.1, 0.3])
    gap = goal - palm
    force = 200.0 * gap - 10.0 * velocity - 30.0 * np.linalg.norm(gap) * velocity
    expected = np.zeros(body.nv)
    expected[arm.dofs] = (jacobian.T @ force - 1.5 * data.qvel)[arm.dofs]
    np.testing.assert_allclose(torque, expected, atol=1e-9)


# --- inverse kinematics -----------------------------------------------------------------------


@pytest.mark.parametrize("landmark", ["left_shoulder.top", "head.back_right", "left_ribs"])
def test_inverse_kinematics_brings_the_palm_onto_a_landmark(body: Body, landmark: str) -> None:
    arm, mark = body.arm("right_arm"), body.landmark(landmark)
    normal = -body.from_link(mark.link, mark.normal)
    (angles,), (miss,) = reach(body, arm, [PalmGoal(mark, normal=normal, touched=mark.link)])
    place, turned, _, _ = body.palm_goal(arm, angles)
    goal = body.at_home(mark.link, mark.point) - body.at_home(arm.root, np.zeros(3))
    assert np.linalg.norm(place - goal) < 2e-3
    assert miss < 2e-3
    assert np.rad2deg(np.arccos(turned @ normal)) < 10
    low, high = body.range
    assert np.all(angles[arm.dofs] > low[arm.dofs] - 1e-3)
    assert np.all(angles[arm.dofs] < high[arm.dofs] + 1e-3)


def test_what_is_out_of_reach_is_missed_by_as_much(body: Body) -> None:
    arm = body.arm("right_arm")
    shoulder = body.at_home(arm.upper_arm, np.zeros(3)) - body.at_home(arm.root, np.zeros(3))
    far = shoulder + np.array([body.reach(arm) + 0.2, 0.0, 0.0])
    _, (miss,) = reach(body, arm, [PalmGoal(Spot(arm.root, far, np.zeros(3)))])
    assert 0.19 < miss < 0.24


# --- any sub-task, any controller --------------------------------------------------------------


@pytest.mark.parametrize("controller", CONTROLLERS)
def test_every_subtask_can_be_given_to_every_controller(body: Body, controller: str) -> None:
    spec, document = load_variant("macarena", controller)
    task = bind_task(spec, body, document)
    recording = run_task(task, contributions=False)[0]
    assert [s.outcome for s in recording.spans] == ["done"] * 12
    assert np.isfinite(recording.torque).all()
    spans = {s.name: s for s in recording.spans}
    for subtask, field in zip(task.spec.subtasks, task.fields, strict=True):
        assert subtask.does.controller == controller
        start = spans[subtask.name].start
        later = [
            spans[s.name].start
            for s in task.spec.subtasks
            if s.does.limb == subtask.does.limb and spans[s.name].start > start
        ]
        first, last = recording.row(start), recording.row(min(later, default=np.inf)) - 1
        world = World(body, 2)
        world.reset(recording.qpos[[first, last]])
        before, after = field.error(world.state)
        assert after < max(0.6 * before, 0.1), f"{subtask.name} is no nearer to its goal"


def test_one_word_in_a_task_file_swaps_the_controller(body: Body) -> None:
    text = """
task: swap
subtasks:
  - {{name: touch, primitive: go-to-point, controller: {}, limb: right_arm, to: chest.front}}
"""
    for controller in CONTROLLERS:
        spec, document = task_from_text(text.format(controller))
        task = bind_task(spec, body, document)
        assert task.fields[0].torque(World(body).state, np.zeros(1)).shape == (1, body.nv)


@pytest.mark.parametrize(
    ("parameters", "said"),
    [
        ("controller: pd-servo, width: 0.3", "width belongs to the controller torque-field"),
        ("controller: torque-field, turn_damping: 1", "turn_damping belongs to the controller imp"),
        ("controller: motor", "motor"),
    ],
)
def test_a_parameter_of_another_controller_is_refused(parameters: str, said: str) -> None:
    text = f"""
task: wrong
subtasks:
  - {{name: touch, primitive: go-to-point, limb: right_arm, to: chest.front, {parameters}}}
"""
    with pytest.raises(SpecError, match=said):
        task_from_text(text)


def test_joints_that_are_no_arm_have_no_hand_to_pull() -> None:
    with pytest.raises(ValueError, match="give limb"):
        GetPosture(controller="impedance", joints=("waist",), posture="upright")
