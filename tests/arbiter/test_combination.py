"""Combination rules: what each promises, on random states and in real physics."""

from typing import Literal

import numpy as np
import pytest

from adonis.dancing import random_start, run_task
from arbiter import Arbiter, ArbiterError
from primitives import CompensateGravity, Follow, GetPosture, GoToPoint, Hold, Primitive
from sim import Body, State, World, joint_inertia
from specs import Background, Group, SpecError, SubTask, TaskSpec, bind_task, task_from_text


def reach(side: str, to: str = "chest.front", **more) -> GoToPoint:
    return GoToPoint(limb=f"{side}_arm", to=to, **more)


def posture(*joints: str, name: str = "rest") -> GetPosture:
    return GetPosture(joints=joints, posture=name)


def asked(body: Body, groups: tuple[Group, ...], **fields) -> tuple[Arbiter, World]:
    """An arbiter of background entries alone, some seconds in, over random states."""
    spec = TaskSpec(
        task="rules",
        background=tuple(Background(name=k, does=v) for k, v in fields.items()),
        groups=groups,
        subtasks=(SubTask(name="idle", does=CompensateGravity(), seconds=1000.0),),
    )
    n = 6
    rng = np.random.default_rng(2)
    low, high = body.range
    q = np.clip(body.home + rng.normal(0, 0.3, (n, body.nv)), low + 0.05, high - 0.05)
    world = World(body, n, inertia=True)
    arbiter = Arbiter(bind_task(spec, body), n)
    world.reset(body.home)
    arbiter.torque(world.state)
    world.reset(q, rng.normal(0, 1, (n, body.nv)))
    return arbiter, world


def accelerations(body: Body, state: State, torque: np.ndarray, jacobian: np.ndarray) -> np.ndarray:
    """What torques (n, nv) do to the speed of a task (n, m)."""
    inertia = joint_inertia(body, state.M)
    return np.einsum("nmj,nj->nm", jacobian, np.linalg.solve(inertia, torque[..., None])[..., 0])


# --- null-space -------------------------------------------------------------------------------

LEVELS = {
    "one arm": (
        {"hand": reach("right"), "arm": posture("right_arm")},
        ("hand", "arm"),
    ),
    "both arms and a shared waist": (
        {"hands": reach("right"), "other": reach("left"), "waist": posture("waist", "neck")},
        ("hands", "other", "waist"),
    ),
    "three levels": (
        {"waist": posture("waist"), "hand": reach("right"), "arm": posture("right_arm")},
        ("waist", "hand", "arm"),
    ),
    "a follower over what is held": (
        {"hand": Follow(limb="right_arm", to="left_hip"), "arm": Hold(limb="right_arm")},
        ("hand", "arm"),
    ),
    "what is held over a hand": (
        {"waist": Hold(joints=("waist", "right_elbow")), "hand": reach("right")},
        ("waist", "hand"),
    ),
    "without the waist": (
        {"hand": reach("left", "belly.front"), "arm": posture("left_arm")},
        ("hand", "arm"),
    ),
}


@pytest.mark.parametrize("case", LEVELS)
def test_a_lower_task_does_not_move_a_higher_one(body: Body, case: str) -> None:
    fields, order = LEVELS[case]
    group = Group(name="all", rule="null-space", members=order)
    arbiter, world = asked(body, (group,), **fields)
    arbiter.torque(world.state)
    made = arbiter.contribution
    for higher in range(len(order)):
        field = arbiter.task.background[higher]
        jacobian = field.jacobian(world.state)
        for lower in range(higher + 1, len(order)):
            own = accelerations(body, world.state, made[:, higher], jacobian)
            moved = accelerations(body, world.state, made[:, lower], jacobian)
            size = np.linalg.norm(own, axis=1)
            assert np.linalg.norm(made[:, lower], axis=1).min() > 1e-3
            assert np.max(np.linalg.norm(moved, axis=1) / size) < 1e-8


def test_the_jacobian_is_that_of_mujoco(body: Body) -> None:
    import mujoco

    world = World(body)
    rng = np.random.default_rng(5)
    world.reset(body.home + rng.normal(0, 0.2, body.nv))
    data = mujoco.MjData(body.model)
    data.qpos[:] = world.state.qpos[0]
    mujoco.mj_forward(body.model, data)
    place, turn = np.zeros((3, body.nv)), np.zeros((3, body.nv))
    mujoco.mj_jacSite(body.model, data, place, turn, body.model.site("right_palm").id)
    field = reach("right").bind(body, 1.0)
    np.testing.assert_allclose(field.jacobian(world.state)[0], np.vstack([place, turn]), atol=1e-9)


@pytest.mark.parametrize(
    ("members", "said"),
    [
        (("arm", "hand"), "nothing is left for 'hand'"),
        (("weight", "hand"), "'weight' has no goal that could be protected"),
        (("hand", "nobody"), "unknown member 'nobody'"),
    ],
)
def test_priorities_that_mean_nothing_are_refused(body: Body, members, said: str) -> None:
    fields = {"hand": reach("right"), "arm": posture("right_arm"), "weight": CompensateGravity()}
    with pytest.raises(SpecError, match=said):
        asked(body, (Group(name="all", rule="null-space", members=members),), **fields)


class Aim(Primitive):
    """Like a servo on one joint, in plain Python."""

    kind: Literal["aim"] = "aim"
    joint: str
    rows: int = 1

    def bind(self, body: Body, duration: float) -> "AimField":
        return AimField(body.joints(self.joint), self.rows)


class AimField:
    unit = "rad"

    def __init__(self, dofs: np.ndarray, rows: int) -> None:
        self.claims, self.rows = dofs, rows

    def begin(self, state: State, who: np.ndarray) -> None:
        pass

    def torque(self, state: State, t: np.ndarray) -> np.ndarray:
        return -5.0 * state.qvel * self.jacobian(state)[:, 0]

    def error(self, state: State) -> np.ndarray:
        return np.abs(state.qpos[:, self.claims[0]])

    def jacobian(self, state: State) -> np.ndarray:
        return np.tile(np.eye(state.qvel.shape[1])[self.claims], (state.n, self.rows, 1))


def test_what_is_plain_python_can_come_first(body: Body) -> None:
    fields = {"aim": Aim(joint="right_elbow"), "hand": reach("right")}
    group = Group(name="all", rule="null-space", members=("aim", "hand"))
    arbiter, world = asked(body, (group,), **fields)
    arbiter.torque(world.state)
    jacobian = arbiter.task.background[0].jacobian(world.state)
    made = arbiter.contribution
    moved, hand = (
        accelerations(body, world.state, made[:, 1], rows)
        for rows in (jacobian, arbiter.task.background[1].jacobian(world.state))
    )
    assert np.abs(moved).max() < 1e-10 * np.abs(hand).min()
    wrong = r"jacobian of 'aim' is of shape \(6, 99, 20\); expected"
    with pytest.raises(ArbiterError, match=wrong):
        asked(body, (group,), **fields | {"aim": Aim(joint="right_elbow", rows=99)})


def test_threads_and_the_batch_change_nothing(body: Body) -> None:
    """Every rule, 300 simulations on two threads and some of them alone."""
    besides = """  - {name: one, primitive: hold, limb: right_arm}
  - {name: two, primitive: hold, joints: [waist]}
groups:
  - {name: waist, rule: weighted, members: [upright, two], weights: {two: 0.5}}"""
    outer = "subtasks:"
    more = "  - {name: more, rule: dominant, members: [first-the-hand, one]}\n"
    text = TEXT.format(rule="null-space").replace("groups:", besides).replace(outer, more + outer)
    spec, document = task_from_text(text)
    task = bind_task(spec, body, document)
    starts = random_start(body, task.start, 300, seed=1)
    runs = {}
    for name, rows, threads in (("all", starts, 2), ("some", starts[[0, 150, 299]], 1)):
        world, arbiter = World(body, len(rows)), Arbiter(task, len(rows), threads=threads)
        world.reset(rows)
        for _ in range(150):
            world.step(arbiter.torque(world.state))
        runs[name] = world.state.qpos.copy()
    np.testing.assert_array_equal(runs["all"][[0, 150, 299]], runs["some"])


# --- the other rules --------------------------------------------------------------------------


def parts(body: Body, **fields) -> np.ndarray:
    """What each of some entries asks for alone, (entries, n, nv)."""
    found = []
    for name, does in fields.items():
        arbiter, world = asked(body, (), **{name: does})
        arbiter.torque(world.state)
        found.append(arbiter.contribution[:, 0].copy())
    return np.array(found)


TWO = {"hand": reach("right"), "arm": posture("right_arm")}


def test_sum_adds_what_each_asks_for(body: Body) -> None:
    group = Group(name="both", members=("hand", "arm"))
    arbiter, world = asked(body, (group,), **TWO)
    hand, arm = parts(body, **TWO)
    limit = body.torque_limit
    expected = np.clip(hand + arm, -limit, limit)
    np.testing.assert_allclose(arbiter.torque(world.state), expected, atol=1e-9)


def test_weighted_is_the_average_where_both_are_on(body: Body) -> None:
    group = Group(name="both", rule="weighted", members=("hand", "arm"), weights={"hand": 3.0})
    arbiter, world = asked(body, (group,), **TWO)
    hand, arm = parts(body, **TWO)
    arbiter.torque(world.state)
    limit = body.torque_limit
    expected = np.clip((3.0 * hand + arm) / 4.0, -limit, limit)
    np.testing.assert_allclose(arbiter.torque(world.state), expected, atol=1e-9)


def test_dominant_gives_everything_to_the_strongest_in_the_end(body: Body) -> None:
    group = Group(name="both", rule="dominant", members=("hand", "arm"), weights={"arm": 2.0})
    arbiter, world = asked(body, (group,), **TWO)
    _, arm = parts(body, **TWO)
    for _ in range(3):
        torque = arbiter.torque(world.state)
    limit = body.torque_limit
    np.testing.assert_allclose(torque, np.clip(arm, -limit, limit), atol=1e-9)


def test_groups_nest(body: Body) -> None:
    fields = {**TWO, "other": posture("right_arm", name="rest")}
    inner = Group(name="inner", rule="weighted", members=("arm", "other"))
    outer = Group(name="outer", rule="sum", members=("hand", "inner"))
    arbiter, world = asked(body, (inner, outer), **fields)
    hand, arm, other = parts(body, **fields)
    limit = body.torque_limit
    expected = np.clip(hand + 0.5 * (arm + other), -limit, limit)
    np.testing.assert_allclose(arbiter.torque(world.state), expected, atol=1e-9)


def test_contributions_add_up_to_the_torque(body: Body) -> None:
    for rule in ("sum", "weighted", "dominant", "null-space"):
        arbiter, world = asked(
            body, (Group(name="all", rule=rule, members=("hand", "arm")),), **TWO
        )
        torque = arbiter.torque(world.state)
        limit = body.torque_limit
        whole = np.clip(arbiter.contribution.sum(axis=1), -limit, limit)
        np.testing.assert_allclose(whole, torque, atol=1e-9)


TEXT = """
task: groups
hand_over: 0.2
background:
  - {{name: upright, primitive: get-posture, joints: [waist, neck], posture: upright}}
  - {{name: loose, primitive: get-posture, joints: [right_arm], posture: rest,
     stiffness: 20, damping: 1}}
  - {{name: weight, primitive: compensate-gravity}}
groups:
  - {{name: first-the-hand, rule: {rule}, members: [touch, loose]}}
subtasks:
  - {{name: touch, primitive: go-to-point, limb: right_arm, to: {{point: [0.35, -0.1, 0.3]}},
     seconds: 1}}
"""


def run(body: Body, rule: str):
    spec, document = task_from_text(TEXT.format(rule=rule))
    return run_task(bind_task(spec, body, document))[0]


def test_a_hand_with_priority_arrives_where_a_sum_falls_short(body: Body) -> None:
    miss = {}
    for rule in ("sum", "null-space", "dominant"):
        recording = run(body, rule)
        world = World(body)
        world.reset(recording.qpos[-1])
        spec, document = task_from_text(TEXT.format(rule=rule))
        field = bind_task(spec, body, document).fields[0]
        miss[rule] = float(field.error(world.state)[0])
        steps = np.abs(np.diff(recording.torque, axis=0)) / body.torque_limit
        assert steps.max() < 0.1
    assert miss["sum"] > 0.05  # the loose posture pulls it back
    assert miss["null-space"] < 0.2 * miss["sum"]
    assert miss["dominant"] < 0.2 * miss["sum"]


def test_a_group_that_is_run_twice_is_the_same_to_the_bit(body: Body) -> None:
    one, two = run(body, "null-space"), run(body, "null-space")
    np.testing.assert_array_equal(one.qpos, two.qpos)
    np.testing.assert_array_equal(one.contribution, two.contribution)


# --- superposition ----------------------------------------------------------------------------


def test_two_parallel_springs_rest_where_their_stiffness_says(body: Body) -> None:
    """x = K^-1 sum K_i x_i, for two hand springs on one palm (FACTS: parallel springs add)."""
    springs = {
        "one": ((0.34, -0.12, 0.30), 600.0),
        "two": ((0.30, -0.04, 0.36), 1800.0),
    }
    free = {"upper_arm_stiffness": 1e-6, "turn_stiffness": 1e-6, "turn_damping": 0.3}
    spec = TaskSpec(
        task="springs",
        background=(
            *(
                Background(
                    name=name,
                    does=GoToPoint(
                        limb="right_arm", to={"point": point}, stiffness=k, damping=60.0, **free
                    ),
                )
                for name, (point, k) in springs.items()
            ),
            Background(name="trunk", does=GetPosture(joints=("waist",), posture="upright")),
            Background(name="weight", does=CompensateGravity()),
        ),
        subtasks=(SubTask(name="wait", does=CompensateGravity(), seconds=6.0),),
    )
    recording = run_task(bind_task(spec, body), contributions=False)[0]
    world = World(body)
    world.reset(recording.qpos[-1])
    arm = body.arm("right_arm")
    axes = world.state.xmat[0, arm.root].reshape(3, 3)
    palm = world.state.xpos[0, arm.hand] + world.state.xmat[0, arm.hand].reshape(3, 3) @ (
        arm.palm.point
    )
    local = axes.T @ (palm - world.state.xpos[0, arm.root])
    (a, k), (b, m) = springs.values()
    expected = (k * np.array(a) + m * np.array(b)) / (k + m)
    assert np.linalg.norm(local - expected) < 1e-4


def test_energy_never_grows_with_passive_fields_alone(body: Body) -> None:
    """Kinetic energy and that of every spring, from random starts: H(t) <= H(earlier)."""
    n, dofs = 6, np.arange(body.nv)
    servo = GetPosture(joints=("all",), posture="rest", stiffness=15.0, damping=0.6)
    wells = GetPosture(
        controller="torque-field", joints=("right_arm", "left_arm"), posture="rest",
        stiffness=8.0, width=0.7, damping=0.2,
    )  # fmt: skip
    spec = TaskSpec(
        task="passive",
        background=(
            Background(name="servo", does=servo),
            Background(name="wells", does=wells),
            Background(name="weight", does=CompensateGravity()),
        ),
        subtasks=(
            SubTask(
                name="wait",  # a task needs something to do
                does=GetPosture(
                    joints=("neck_z",), posture={"neck_z": 0}, stiffness=1e-6, damping=0.0
                ),
                seconds=1000.0,
            ),
        ),
    )
    task = bind_task(spec, body)
    start = random_start(body, task.start, n, seed=4)
    world, arbiter = World(body, n, inertia=True), Arbiter(task, n)
    world.reset(start)
    goal = body.posture("rest")
    arms = body.joints(("right_arm", "left_arm"))
    free = np.setdiff1d(dofs, body.joints("neck_z"))
    energies = []
    for step_ in range(5000):
        if step_ % 50 == 0 and step_ >= 300:  # by then the set points have arrived
            v, e = world.state.qvel, world.state.qpos[:, body.qpos_of_dof] - goal
            kinetic = 0.5 * np.einsum("ni,nij,nj->n", v, joint_inertia(body, world.state.M), v)
            springs = 0.5 * 15.0 * np.sum(e[:, free] ** 2, axis=1)
            wells_ = 8.0 * 0.7**2 * np.sum(1 - np.exp(-(e[:, arms] ** 2) / (2 * 0.7**2)), axis=1)
            energies.append(kinetic + springs + wells_)
        world.step(arbiter.torque(world.state))
    energy = np.array(energies)
    assert energy[0].min() > 1.0
    growth = np.diff(energy, axis=0) / energy[0]
    assert growth.max() < 1e-3
    assert np.all(energy[-1] < 0.01 * energy[0])


# --- sub-tasks side by side -------------------------------------------------------------------

SIDE_BY_SIDE = """
task: side-by-side
hand_over: 0.1
background: [{{name: weight, primitive: compensate-gravity}}]
groups: [{{name: both, rule: {rule}, members: [up, down, then], weights: {{up: 3}}}}]
subtasks:
  - {{name: up, primitive: get-posture, joints: [right_elbow], posture: {{right_elbow: 80}}}}
  - {{name: down, primitive: get-posture, joints: [right_elbow], posture: {{right_elbow: 20}},
     after: []}}
  - {{name: then, primitive: get-posture, joints: [right_elbow], posture: {{right_elbow: 50}},
     after: {after}, beats: 2}}
"""


def elbow(body: Body, rule: str, after: str) -> tuple[float, float]:
    """Its angle after one and after three seconds [deg]."""
    spec, document = task_from_text(SIDE_BY_SIDE.format(rule=rule, after=after))
    (recording,) = run_task(bind_task(spec, body, document))
    angle = np.rad2deg(recording.qpos[:, body.qpos_of_dof[body.joints("right_elbow")[0]]])
    return float(angle[recording.row(1.0)]), float(angle[-1])


def test_sub_tasks_of_a_group_act_at_once_unless_one_comes_after_the_other(body: Body) -> None:
    """Springs alike: the average of where they pull, by weight; then the last alone."""
    middle, end = elbow(body, "weighted", "[up, down]")
    assert middle == pytest.approx(0.75 * 80 + 0.25 * 20, abs=2)
    assert end == pytest.approx(50, abs=1)
    middle, end = elbow(body, "dominant", "[up, down]")
    assert middle == pytest.approx(80, abs=2)
    assert end == pytest.approx(50, abs=1)
    _, end = elbow(body, "weighted", "[up]")  # `down` is beside it, `up` is not
    assert end == pytest.approx(0.5 * (20 + 50), abs=2)


def test_without_a_group_they_are_refused(body: Body) -> None:
    text = SIDE_BY_SIDE.format(rule="weighted", after="[up, down]")
    lines = [line for line in text.splitlines() if not line.startswith("groups")]
    spec, document = task_from_text("\n".join(lines))
    with pytest.raises(SpecError, match="both claim right_elbow, and neither comes after"):
        bind_task(spec, body, document)
