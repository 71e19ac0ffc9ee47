"""The arbiter: activations that add up, a beat that does not drift, batches that agree."""

from typing import Literal

import mujoco
import numpy as np
import pytest

from adonis.dancing import random_start, run_task
from arbiter import Arbiter, ArbiterError
from arbiter.kernel import control
from primitives import AvoidCollisions, CompensateGravity, GetPosture, GoToPoint, Primitive
from sim import Body, State, World
from specs import Background, SubTask, TaskSpec, bind_task


class Constant(Primitive):
    """One newton metre on some joints: what comes out is its activation."""

    kind: Literal["constant"] = "constant"
    joints: tuple[str, ...]
    torque_value: float = 1.0
    claiming: bool = True

    def bind(self, body: Body, duration: float):
        return ConstantField(body.joints(self.joints), self.torque_value, self.claiming, body.nv)


class Broken(Constant):
    """A bug in somebody's primitive."""

    kind: Literal["broken"] = "broken"

    def bind(self, body: Body, duration: float):
        return ConstantField(body.joints(self.joints), np.nan, True, body.nv)


class ConstantField:
    unit = "rad"

    def __init__(self, dofs, value: float, claiming: bool, nv: int) -> None:
        self.claims = dofs if claiming else dofs[:0]
        self._torque = np.zeros(nv)
        self._torque[dofs] = value
        self.begun: list[float] = []

    def begin(self, state: State, who) -> None:
        self.begun.append(float(state.time[0]))

    def torque(self, state: State, t):
        return np.tile(self._torque, (state.n, 1))

    def error(self, state: State):
        return np.abs(state.time - 1.0)  # "reached" after one second


def task_of(body: Body, *subtasks: SubTask, background=(), **more):
    spec = TaskSpec(task="t", subtasks=subtasks, background=background, tempo=60, **more)
    return bind_task(spec, body)


def play(bound, seconds: float) -> tuple[Arbiter, np.ndarray]:
    """Run a task on a body that nothing moves; the torques asked for, (T, nv)."""
    world = World(bound.body)
    arbiter = Arbiter(bound)
    asked = []
    for _ in range(round(seconds / bound.body.timestep)):
        asked.append(arbiter.torque(world.state)[0].copy())
        world.step(np.zeros((1, bound.body.nv)))
    return arbiter, np.array(asked)


def constant(*joints: str, value: float = 1.0, claiming: bool = True) -> Constant:
    return Constant(joints=joints, torque_value=value, claiming=claiming)


def test_on_every_joint_activations_add_up_to_one_whatever_interrupts_what(body: Body) -> None:
    """Background, limb, part of a limb, both arms: each takes over while another fades."""
    bound = task_of(
        body,
        SubTask(name="right", does=constant("right_arm"), seconds=0.3),
        SubTask(name="both", does=constant("right_arm", "left_arm"), seconds=0.1),
        SubTask(name="elbow", does=constant("right_elbow"), seconds=0.05),
        SubTask(name="right-again", does=constant("right_arm"), seconds=0.3),
        SubTask(name="neck", does=constant("neck"), after=("right",), seconds=0.5),
        background=(Background(name="all", does=constant("all")),),
        hand_over=0.2,
    )
    _, asked = play(bound, 2.0)
    np.testing.assert_allclose(asked, 1.0, atol=1e-9)


def test_a_goal_is_held_until_its_joints_are_claimed_again(body: Body) -> None:
    bound = task_of(
        body,
        SubTask(name="a", does=constant("right_elbow", "neck", value=2.0), seconds=0.2),
        SubTask(name="b", does=constant("right_elbow", value=5.0), seconds=0.2),
        background=(Background(name="rest", does=constant("all", value=1.0)),),
        hand_over=0.1,
    )
    _, asked = play(bound, 1.0)
    elbow, neck = body.joints("right_elbow")[0], body.joints("neck")[0]
    assert asked[90, elbow] == pytest.approx(2.0)
    assert asked[-1, elbow] == pytest.approx(5.0)
    assert asked[-1, neck] == pytest.approx(2.0), "nobody claimed the neck again"
    assert asked[-1, body.joints("waist")[0]] == pytest.approx(1.0)
    assert np.abs(np.diff(asked[:, elbow])).max() < 4.0 * 2.0 * body.timestep / 0.1, "cross-fade"


def test_what_claims_nothing_is_added_while_it_runs_and_then_fades(body: Body) -> None:
    bound = task_of(
        body,
        SubTask(name="add", does=constant("neck", value=3.0, claiming=False), seconds=0.3),
        background=(Background(name="rest", does=constant("all")),),
        hand_over=0.1,
    )
    _, asked = play(bound, 1.0)
    neck = body.joints("neck")[0]
    assert asked[100, neck] == pytest.approx(4.0)
    assert asked[-1, neck] == pytest.approx(1.0)


def test_the_beat_does_not_drift(body: Body) -> None:
    """1/3 s is no multiple of 2 ms; the hundredth still begins at 33 s."""
    subtasks = [SubTask(name=f"s{k}", does=constant("neck"), seconds=1 / 3) for k in range(12)]
    bound = task_of(body, *subtasks)
    arbiter, _ = play(bound, 4.1)
    for k, span in enumerate(arbiter.spans()):
        assert span.start == pytest.approx(k / 3, abs=1e-9)
        assert span.end == pytest.approx((k + 1) / 3, abs=1e-9)
        assert span.outcome == "done"


def test_a_join_waits_for_all_and_a_fork_begins_all(body: Body) -> None:
    bound = task_of(
        body,
        SubTask(name="a", does=constant("right_arm"), seconds=0.2),
        SubTask(name="b", does=constant("left_arm"), after=(), seconds=0.5),
        SubTask(name="c", does=constant("neck"), after=("a", "b"), seconds=0.1),
        SubTask(name="d", does=constant("waist"), after=("a", "b"), seconds=0.1),
    )
    arbiter, _ = play(bound, 1.0)
    spans = {s.name: s for s in arbiter.spans()}
    assert spans["c"].start == spans["d"].start == pytest.approx(0.5)


def test_reached_ends_when_the_error_is_small_enough_or_the_time_is_up(body: Body) -> None:
    def waits(tolerance: float, timeout: float) -> dict:
        return {"done": "reached", "tolerance": tolerance, "timeout": timeout}

    bound = task_of(
        body,
        SubTask(name="in-time", does=constant("neck"), seconds=0.2, **waits(0.3, 5.0)),
        SubTask(name="too-late", does=constant("neck"), seconds=0.2, **waits(1e-6, 0.25)),
        SubTask(name="next", does=constant("neck"), seconds=0.2),
    )
    arbiter, _ = play(bound, 2.0)
    first, second, third = arbiter.spans()
    assert first.outcome == "done"
    assert first.end == pytest.approx(0.7, abs=2 * body.timestep)
    assert second.outcome == "timed out"
    assert second.end == pytest.approx(first.end + 0.25, abs=2 * body.timestep)
    assert third.start == second.end


def test_reached_sees_the_hand_arrive(body: Body) -> None:
    reach = GoToPoint(limb="right_arm", to={"point": (0.4, -0.2, 0.3)})
    spec = TaskSpec(
        task="t",
        subtasks=(
            SubTask(
                name="go", does=reach, seconds=0.4, done="reached", tolerance=0.005, timeout=4.0
            ),
        ),
        background=(
            Background(name="hold", does=GetPosture(joints=("waist", "neck"), posture="upright")),
            Background(name="weight", does=CompensateGravity()),
        ),
    )
    (recording,) = run_task(bind_task(spec, body))
    (span,) = recording.spans
    assert span.outcome == "done"
    assert 0.4 <= span.end < 4.0


def test_a_plain_primitive_is_begun_once_in_each_simulation(body: Body) -> None:
    bound = task_of(
        body,
        SubTask(name="a", does=constant("neck"), seconds=0.1),
        SubTask(name="b", does=constant("neck"), seconds=0.1),
        background=(Background(name="rest", does=constant("waist")),),
    )
    play(bound, 0.5)
    assert [f.begun for f in bound.background] == [[0.0]]
    assert bound.fields[0].begun == [0.0]
    np.testing.assert_allclose(bound.fields[1].begun, [0.1], atol=1e-9)


def test_torques_stay_within_the_motors_limits(body: Body) -> None:
    bound = task_of(body, SubTask(name="a", does=constant("all", value=1e6), seconds=1.0))
    _, asked = play(bound, 0.5)
    np.testing.assert_allclose(asked[-1], body.torque_limit)


def test_a_torque_that_is_no_number_is_named(body: Body) -> None:
    bound = task_of(
        body,
        SubTask(name="fine", does=constant("neck"), seconds=0.1),
        SubTask(name="broken", does=Broken(joints=("right_elbow",)), seconds=0.1),
    )
    with pytest.raises(ArbiterError, match=r"'broken' .* right_elbow, 0\.1\d\d s"):
        play(bound, 0.5)


class Own(Primitive):
    """A primitive of somebody's own, with a mistake in it."""

    kind: Literal["own"] = "own"
    part: str
    wrong: str

    def bind(self, body: Body, duration: float):
        return OwnField(body, self.part, self.wrong)


class OwnField(ConstantField):
    def __init__(self, body: Body, part: str, wrong: str) -> None:
        super().__init__(body.joints("neck"), 1.0, True, body.nv)
        self._part, self._wrong = part, wrong

    def _returned(self, part: str, right):
        if part != self._part:
            return right
        if self._wrong == "raises":
            return np.linalg.inv(np.zeros((2, 2)))  # raised in numpy, but this line is ours
        if self._wrong == "ends":
            raise SystemExit
        others = {
            "nothing": None,
            "words": "much",
            "one row": right[0],
            "complex": right + 1j,
            "ragged": [[1.0], [1.0, 2.0]],
            "a list": right.tolist(),
        }
        return others[self._wrong]

    def begin(self, state: State, who) -> None:
        self._returned("begin", None)

    def torque(self, state: State, t):
        return self._returned("torque", super().torque(state, t))

    def error(self, state: State):
        return self._returned("error", super().error(state))


@pytest.mark.parametrize(
    ("part", "wrong", "said"),
    [
        ("begin", "raises", r"raised LinAlgError: Singular matrix \(.*test_arbiter\.py:\d+\)$"),
        ("torque", "raises", r"raised LinAlgError: Singular matrix \(.*test_arbiter\.py:\d+\)$"),
        ("error", "raises", r"raised LinAlgError: Singular matrix \(.*test_arbiter\.py:\d+\)$"),
        ("torque", "ends", r"raised SystemExit \("),
        ("torque", "nothing", r"returned None; .* shape \(n, nv\), here \(2, 20\)$"),
        ("torque", "words", "returned something of type str; expected numbers"),
        ("torque", "one row", r"returned float64 of shape \(20,\); expected .* \(n, nv\)"),
        ("torque", "complex", r"returned complex128 of shape \(2, 20\)"),
        ("torque", "ragged", "returned something of type list"),
        ("error", "nothing", r"returned None; expected numbers of shape \(n,\), here \(2,\)$"),
        ("error", "one row", "returned something of type float64; expected"),
    ],
)
def test_a_mistake_in_somebody_s_own_code_is_named(body: Body, part, wrong, said) -> None:
    bound = task_of(body, SubTask(name="wobble", does=Own(part=part, wrong=wrong), seconds=1.0))
    arbiter = Arbiter(bound, 2)
    with pytest.raises(ArbiterError, match=f"^the {part} of 'wobble' {said}") as caught:
        arbiter.torque(World(body, 2).state)
    assert "\n" not in str(caught.value)


def test_torques_may_be_lists(body: Body) -> None:
    does = Own(part="torque", wrong="a list")
    _, asked = play(task_of(body, SubTask(name="a", does=does, seconds=0.1)), 0.2)
    assert asked[-1, body.joints("neck")].tolist() == [1.0, 1.0, 1.0]


def test_a_state_of_another_size_is_refused(body: Body) -> None:
    bound = task_of(body, SubTask(name="a", does=constant("neck"), seconds=0.1))
    with pytest.raises(ArbiterError, match="runs 2 simulations"):
        Arbiter(bound, 2).torque(World(body, 3).state)


def test_reset_begins_anew_in_some_simulations(body: Body) -> None:
    bound = task_of(
        body,
        SubTask(name="a", does=constant("neck"), seconds=0.1),
        SubTask(name="b", does=constant("neck"), seconds=0.1),
    )
    world, arbiter = World(body, 2), Arbiter(bound, 2)
    for _ in range(80):
        arbiter.torque(world.state)
        world.step(np.zeros((2, body.nv)))
    arbiter.reset([1])
    arbiter.torque(world.state)
    assert [s.outcome for s in arbiter.spans(0)] == ["done", "running"]
    assert [s.outcome for s in arbiter.spans(1)] == ["running", "pending"]
    assert arbiter.spans(1)[0].start == pytest.approx(0.16)


def test_run_k_of_a_batch_is_the_same_run_alone_at_any_number_of_threads(dance) -> None:
    task, n = dance.task, 64
    start = random_start(task.body, task.start, n, seed=3)
    start[5] = task.start
    one = run_task(task, n=n, threads=1, start=start, contributions=False)
    two = run_task(task, n=n, threads=2, start=start, contributions=False)
    for k in (0, 5, 17, 63):
        (alone,) = run_task(task, start=start[k], contributions=False)
        for batch in (one, two):
            for name in ("time", "qpos", "qvel", "torque"):
                np.testing.assert_array_equal(getattr(alone, name), getattr(batch[k], name))
            assert alone.spans == batch[k].spans
    np.testing.assert_array_equal(dance.recording.qpos, one[5].qpos)


def test_it_runs_in_a_mujoco_loop_of_one_s_own(dance) -> None:
    """And does there exactly what it does in a World."""
    task, model = dance.task, dance.task.body.model
    data = mujoco.MjData(model)
    data.qpos[:] = task.start
    arbiter = Arbiter(task)
    arbiter.torque(World(task.body).state)
    arbiter.reset()
    compiled = set(control.signatures)
    for k in range(500):
        mujoco.mj_step1(model, data)
        np.testing.assert_array_equal(data.qpos, dance.recording.qpos[k])
        data.ctrl[:] = arbiter.torque(State.of(data))[0]
        mujoco.mj_step2(model, data)
    assert set(control.signatures) == compiled, "nothing was compiled anew"


def test_a_graph_of_ten_thousand_runs(body: Body) -> None:
    right = GoToPoint(limb="right_arm", to="head.top")
    left = GetPosture(limb="left_arm", posture="rest")
    subtasks = tuple(
        SubTask(name=f"s{k}", does=(right, left)[k % 2], seconds=0.01) for k in range(10_000)
    )
    guard = Background(name="guard", does=AvoidCollisions())
    bound = task_of(body, *subtasks, background=(guard,))
    arbiter, _ = play(bound, 0.5)
    outcomes = [s.outcome for s in arbiter.spans()]
    assert outcomes.count("done") == 49
    assert outcomes.count("running") == 1
