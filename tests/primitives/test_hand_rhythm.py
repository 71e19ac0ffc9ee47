"""A hand that swings: where it is by simulation, and what is refused."""

import numpy as np
import pytest
from pydantic import ValidationError

from adonis.dancing import run_task
from adonis.judging import judge
from adonis.judging_rhythm import seen
from primitives import GoToPoint, Oscillate, PrimitiveError
from primitives.testing import check_primitive
from sim import Body, Recording, World
from specs import SpecError, TaskSpec, bind_task, task_from_text

TASK = """
task: conduct
tempo: 60
background:
  - {{name: upright, primitive: get-posture, joints: [waist, neck], posture: upright}}
  - {{name: weight, primitive: compensate-gravity}}
subtasks:
  - {{name: out, primitive: go-to-point, limb: right_arm, beats: 2,
     to: {{point: [0.4, -0.2, 0.3]}}}}
  - name: conduct
    primitive: oscillate
    limb: right_arm
    at: {{point: [0.4, -0.2, 0.3]}}
    along: {{up: {{amplitude: 0.08}}, left: {{amplitude: 0.05, lag: 90}}}}
    beats_per_cycle: 1
    beats: 6
    {more}
"""
ONE = {"limb": "right_arm", "along": {"up": {"amplitude": 0.05}}, "frequency": 1}


def conducted(body: Body, more: str = "") -> tuple[TaskSpec, Recording]:
    spec, document = task_from_text(TASK.format(more=more))
    (recording,) = run_task(bind_task(spec, body, document))
    return spec, recording


def palm(body: Body, recording: Recording) -> np.ndarray:
    """Where the palm was in the frame of the trunk (T, 3) [m]."""
    world, arm = World(body, len(recording.time)), body.arm("right_arm")
    world.reset(recording.qpos)
    axes = world.state.xmat.reshape(len(recording.time), -1, 3, 3)
    place = world.state.xpos[:, arm.hand] + axes[:, arm.hand] @ arm.palm.point
    return np.einsum("tji,tj->ti", axes[:, arm.root], place - world.state.xpos[:, arm.root])


@pytest.mark.parametrize("oscillator", ["sine", "hopf", "matsuoka"])
def test_a_hand_swings_about_a_place_as_joints_do(body: Body, oscillator: str) -> None:
    spec, recording = conducted(body, f"oscillator: {oscillator}")
    place, time = palm(body, recording), recording.time
    rows = (time > 3.0) & (time < 7.0)
    up, left = (seen(time[rows], place[rows, k], 1.0) for k in (2, 1))
    assert up.frequency == pytest.approx(1.0, rel=0.01)
    np.testing.assert_allclose(up.amplitudes, 0.08, rtol=0.1)
    np.testing.assert_allclose(left.amplitudes, 0.05, rtol=0.1)
    assert np.rad2deg(up.phase - left.phase) % 360 == pytest.approx(90, abs=5)
    np.testing.assert_allclose(place[rows].mean(axis=0), (0.4, -0.2, 0.3), atol=0.005)
    judgement = judge(recording, spec)
    assert judgement.success
    found = {m.what for m in judgement.verdicts[1].measures}
    assert found == {"frequency off", "amplitude off", "lag off", "centre off"}


@pytest.mark.parametrize(
    ("asked", "off"),
    [
        ("beats_per_cycle: 1.1", "frequency off"),
        ("along: {up: {amplitude: 0.05}}", "amplitude off"),
        ("along: {up: {amplitude: 0.08}, left: {amplitude: 0.05}}", "lag off"),
        ("at: {point: [0.4, -0.2, 0.36]}", "centre off"),
    ],
)
def test_the_judge_sees_what_another_would_have_been(body: Body, asked: str, off: str) -> None:
    spec, recording = conducted(body)
    key = asked.partition(":")[0]
    lines = [line for line in TASK.splitlines() if not line.strip().startswith(f"{key}:")]
    other, _ = task_from_text("\n".join(lines).format(more=asked))
    wrong = {m.what for m in judge(recording, other).verdicts[1].measures if not m.success}
    assert off in wrong
    assert judge(recording, spec).success


def test_a_change_of_tempo_goes_on_where_it_is(body: Body) -> None:
    spec, recording = conducted(body, "then: [{cycle: 3, frequency: 2}]")
    assert judge(recording, spec).success
    up, time = palm(body, recording)[:, 2] - 0.3, recording.time - 2.0
    cycles = np.where(time < 3.0, time, 3.0 + 2.0 * (time - 3.0))
    rows = (time > 1.0) & (time < 5.5)
    assert np.abs(up - 0.08 * np.sin(2 * np.pi * cycles))[rows].max() < 0.3 * 0.08


def test_beside_a_reach_it_moves_what_the_reach_holds(body: Body) -> None:
    """The same torque as the reach to a goal that is moved by the swing."""
    free = {"turn_stiffness": 1e-6, "turn_damping": 0.0, "shoulder_damping": 0.0}
    beside = Oscillate(**ONE, claims=False, ease=0, phase=90).bind(body, np.inf)
    world = World(body)
    world.reset(body.home)
    reaches = [
        GoToPoint(
            limb="right_arm", to={"point": (0.3, -0.2, z)}, profile="linear", travel=1, **free
        ).bind(body, 1e-6)
        for z in (0.2, 0.25)
    ]
    for field in (*reaches, beside):
        field.begin(world.state, np.ones(1, dtype=bool))
    assert beside.claims.tolist() == []
    t = np.array([1.0])
    there, moved = (field.torque(world.state, t) for field in reaches)
    np.testing.assert_allclose(beside.torque(world.state, t), moved - there, atol=1e-9)


def test_it_pats_what_it_may_touch(body: Body) -> None:
    """A landmark is touched, as by go-to-point: the guard lets the hand through to it."""
    text = """
task: pat
background:
  - {name: upright, primitive: get-posture, joints: [waist, neck], posture: upright}
  - {name: guard, primitive: avoid-collisions}
  - {name: weight, primitive: compensate-gravity}
subtasks:
  - {name: rub, primitive: oscillate, limb: left_arm, at: belly.front, frequency: 1, beats: 5,
     ease: 1, along: {up: {amplitude: 0.04}, left: {amplitude: 0.04, lag: 90}}}
"""
    spec, document = task_from_text(text)
    (recording,) = run_task(bind_task(spec, body, document))
    judgement = judge(recording, spec)
    assert judgement.success, [m for v in judgement.verdicts for m in v.measures]


def test_it_keeps_the_promises_of_a_field(body: Body) -> None:
    check_primitive(Oscillate(**ONE | {"frequency": 4}, oscillator="matsuoka", feedback=0.5), body)


def test_a_batch_does_what_each_would_do_alone(body: Body) -> None:
    spec, document = task_from_text(TASK.format(more="oscillator: hopf\n    feedback: 1"))
    task = bind_task(spec, body, document)
    starts = body.home + np.random.default_rng(0).normal(0, 0.05, (3, body.nv))
    for start, recording in zip(starts, run_task(task, n=3, start=starts), strict=True):
        (alone,) = run_task(task, start=start)
        np.testing.assert_array_equal(alone.qpos, recording.qpos)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"along": None}, "a limb swings along directions"),
        ({"joints": {"neck_y": {"amplitude": 5}}}, "either joints, or a limb and along"),
        ({"limb": None}, "either joints, or a limb and along"),
        ({"limb": None, "joints": {"neck_y": {"amplitude": 5}}}, "along goes with a limb"),
        ({"centre": "rest"}, "a hand swings about what 'at' says"),
        ({"at": "belly.front", "claims": False}, "leave 'at' out"),
        ({"along": {"up": {"amplitude": 1}, "down": {"amplitude": 1}}}, "are one line"),
        ({"along": {"up": {"amplitude": 20}}}, "less than or equal to 2"),
        ({"along": {}}, "at least 1"),
    ],
)
def test_parameters_that_mean_nothing_are_refused(wrong: dict, said: str) -> None:
    with pytest.raises(ValidationError, match=said):
        Oscillate(**ONE | wrong)


def test_what_does_not_fit_the_body_is_refused(body: Body) -> None:
    with pytest.raises(PrimitiveError, match=r"oscillate cannot be aimed at 'right_elbow.inside'"):
        Oscillate(**ONE, at="right_elbow.inside").bind(body, 4.0)
    spec, document = task_from_text(TASK.format(more="").replace("left: {", "sideways: {"))
    with pytest.raises(SpecError, match=r"14:36: conduct: unknown direction 'sideways'"):
        bind_task(spec, body, document)
