"""A task says for whom its metres and seconds are, and is made to fit others."""

from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import pytest

from primitives import (
    AvoidCollisions,
    Follow,
    GetPosture,
    GoToPoint,
    Oscillate,
    Place,
    Primitive,
    Quantity,
    Relax,
)
from sim import Body, likeness, load_body
from specs import (
    SpecError,
    bind_task,
    fit_of,
    fitted,
    load_task,
    resized,
    slowed,
    task_from_text,
    task_to_yaml,
)
from specs.tolerances import ARM, size_of

TEXT = """
task: many
body: adonis
tempo: 100
tempo_map: [{beat: 4, tempo: 200}]
hand_over: 0.2
landmarks: {nose: {near: head.front, away: 0.02, offset: [0, 0, -0.03]}}
background:
  - {name: guard, primitive: avoid-collisions, range: 0.02, stiffness: 500}
  - {name: weight, primitive: compensate-gravity}
subtasks:
  - name: reach
    primitive: go-to-point
    limb: right_arm
    to: {near: nose, away: 0.1, offset: [0.01, 0, 0]}
    via: [{point: [0.4, -0.2, 0.3], at: 0.5}]
    upper_arm: [0, -1, 0]
    stiffness: 1200
    done: reached
    tolerance: 0.02
    timeout: 3
  - {name: stretch, primitive: get-posture, limb: left_arm, posture: {arm: forward, palm: up},
     stiffness: 100, damping: 8, seconds: 2, hand_over: 0.3}
  - {name: wells, primitive: get-posture, controller: torque-field, limb: left_arm,
     posture: rest, stiffness: 64}
  - {name: swing, primitive: oscillate, limb: left_arm, along: {up: {amplitude: 0.05}},
     at: {point: [0.3, 0.3, 0.2]}, frequency: 1, then: [{cycle: 2, frequency: 2}], beats: 6,
     if: {near: nose, limb: right_arm, distance: 0.5}}
  - {name: trace, primitive: follow, limb: right_arm, settle: 0.4,
     trajectory: {times: [0, 1], points: [[0.4, -0.2, 0.2], [0.4, 0, 0.2]]}}
  - {name: loose, primitive: relax, limb: left_arm, damping: 0.3}
"""


@pytest.fixture(scope="module")
def giant() -> Body:
    return load_body("adonis-giant")


def test_lengths_times_and_gains_become_those_of_the_other_body(giant: Body) -> None:
    spec, _ = task_from_text(TEXT)
    big = fitted(spec, giant)
    root = 2.0**0.5
    assert (big.body, spec.body) == ("adonis-giant", "adonis")
    assert big.tempo == pytest.approx(100 / root, rel=1e-3)
    assert big.tempo_map[0].tempo == pytest.approx(200 / root, rel=1e-3)
    assert big.tempo_map[0].beat == 4
    assert big.hand_over == pytest.approx(0.2 * root, rel=1e-3)
    assert big.landmarks["nose"].away == pytest.approx(0.04)
    assert big.landmarks["nose"].offset == pytest.approx((0, 0, -0.06))
    guard = big.background[0].does
    assert isinstance(guard, AvoidCollisions)
    assert (guard.range, guard.stiffness, guard.damping) == (0.04, pytest.approx(2000), None)
    reach, stretch, wells, swing, trace, loose = big.subtasks
    does = reach.does
    assert isinstance(does, GoToPoint)
    assert isinstance(does.to, Place)
    assert (does.to.away, does.to.offset) == (0.2, (0.02, 0, 0))
    assert does.via[0].point == pytest.approx((0.8, -0.4, 0.6))
    assert does.via[0].at == 0.5
    assert does.upper_arm == (0, -1, 0), "a direction is none larger"
    assert does.stiffness == pytest.approx(4800, rel=1e-3)
    assert reach.tolerance == pytest.approx(0.04)
    assert reach.timeout == pytest.approx(3 * root, rel=1e-3)
    assert stretch.seconds == pytest.approx(2 * root, rel=1e-3)
    assert stretch.hand_over == pytest.approx(0.3 * root, rel=1e-3)
    posture = stretch.does
    assert isinstance(posture, GetPosture)
    assert posture.stiffness == pytest.approx(1600, rel=1e-3)
    assert posture.damping == pytest.approx(8 * 2**4.5, rel=1e-3)
    well = wells.does
    assert isinstance(well, GetPosture)
    assert well.width == pytest.approx(1 / 8), "eq 3 pairs a width with the old stiffness"
    rhythm = swing.does
    assert isinstance(rhythm, Oscillate)
    assert rhythm.swings["up"].amplitude == pytest.approx(0.1)
    assert rhythm.frequency == pytest.approx(1 / root, rel=1e-3)
    assert rhythm.then[0].frequency == pytest.approx(2 / root, rel=1e-3)
    assert swing.if_ is not None
    assert swing.if_.distance == pytest.approx(1.0)
    follow = trace.does
    assert isinstance(follow, Follow)
    assert follow.trajectory is not None
    assert follow.settle == pytest.approx(0.4 * root, rel=1e-3)
    assert follow.trajectory.times == pytest.approx((0, root), rel=1e-3)
    assert follow.trajectory.points[1] == pytest.approx((0.8, 0, 0.4))
    relaxed = loose.does
    assert isinstance(relaxed, Relax)
    assert relaxed.damping == pytest.approx(0.3 * 2**4.5, rel=1e-3)


def test_what_fits_is_not_fitted_again(giant: Body) -> None:
    spec, _ = task_from_text(TEXT)
    once = fitted(spec, giant)
    assert fitted(once, giant) is once
    assert fit_of(once, giant) is None
    assert bind_task(spec, giant).spec == once
    again, _ = task_from_text(task_to_yaml(once))
    assert again == once
    back = fitted(once, load_body("adonis"))
    assert back.subtasks[0].does == spec.subtasks[0].does
    assert back.tempo == pytest.approx(spec.tempo, rel=1e-3)


def test_a_task_for_nobody_in_particular_stays_as_it_is(giant: Body) -> None:
    spec, _ = task_from_text(TEXT.replace("body: adonis\n", ""))
    assert fitted(spec, giant) is spec


def test_a_tempo_that_is_asked_for_holds(giant: Body) -> None:
    spec, _ = task_from_text(TEXT)
    asked = fitted(spec, giant, tempo=90)
    assert asked.tempo == 90
    assert asked.tempo_map[0].tempo == pytest.approx(180, rel=1e-3)
    assert asked.subtasks[0].does == fitted(spec, giant).subtasks[0].does


def test_nobody_is_told_with_the_line(tmp_path: Path, giant: Body) -> None:
    file = tmp_path / "many.yaml"
    file.write_text(TEXT.replace("body: adonis\n", "body: adnois\n"))
    spec, document = load_task(file)
    with pytest.raises(SpecError, match=r"many\.yaml:3:7: unknown body 'adnois'; did you mean"):
        bind_task(spec, giant, document)


class Push(Primitive):
    """Push."""

    kind: Literal["push"] = "push"
    far: Annotated[float, Quantity.LENGTH] = 0.1
    stiffness: Annotated[float | None, Quantity.GAIN] = None
    times: int = 3

    def torque(self, state, t):
        return np.zeros_like(state.qvel)


def test_a_primitive_of_ones_own_is_scaled_where_it_says_so(giant: Body) -> None:
    text = "task: own\nbody: adonis\nsubtasks: [{name: a, primitive: push, stiffness: 10}]"
    spec, _ = task_from_text(text, primitives=[Push])
    does = fitted(spec, giant).subtasks[0].does
    assert isinstance(does, Push)
    assert (does.far, does.times) == (0.2, 3)
    assert does.stiffness == pytest.approx(160, rel=1e-3)


def test_slower_is_slower_in_every_way() -> None:
    spec, _ = task_from_text(TEXT)
    slow = slowed(spec, 2.0)
    assert (slow.tempo, slow.hand_over) == (50, 0.4)
    reach, stretch, _, swing, trace, _ = slow.subtasks
    assert (reach.timeout, stretch.seconds) == (6, 4)
    assert isinstance(swing.does, Oscillate)
    assert swing.does.frequency == 0.5
    assert isinstance(trace.does, Follow)
    assert trace.does.settle == 0.8
    assert reach.does == spec.subtasks[0].does, "lengths and gains stay"
    assert resized(reach.does, 1.0) == reach.does


def test_tolerances_are_those_of_adonis_and_grow_with_the_arms(body: Body, giant: Body) -> None:
    reach = [body.reach(body.arm(limb)) for limb in body.map.limbs]
    assert np.mean(reach) == pytest.approx(ARM, rel=1e-3)
    assert size_of(body) == 1.0
    assert size_of(giant) == 2.0
    assert size_of(load_body("adonis-child")) == pytest.approx(
        likeness(body, load_body("adonis-child")).length, abs=2e-3
    )


def test_gains_of_a_task_are_factors_of_the_bodys(body: Body) -> None:
    text = "task: firm\ngains: {joints: 4, hands: 0.25, damping: 2, guard: 9}\nsubtasks:\n"
    text += "  [{name: a, primitive: get-posture, limb: left_arm, posture: rest}]"
    spec, _ = task_from_text(text)
    firm, own = bind_task(spec, body).body.map, body.map
    servo, usual = firm.servos["left_elbow"], own.servos["left_elbow"]
    assert servo.stiffness == pytest.approx(4 * usual.stiffness)
    assert servo.damping == pytest.approx(2 * 2 * usual.damping), "at twice the damping ratio"
    spring, loose = firm.limbs["left_arm"].spring, own.limbs["left_arm"].spring
    assert spring.stiffness == pytest.approx(0.25 * loose.stiffness)
    assert spring.turn_damping == pytest.approx(loose.turn_damping)
    assert firm.guard.stiffness == 9 * own.guard.stiffness
    assert firm.guard.damping == 3 * own.guard.damping
    with pytest.raises(SpecError, match="joints should be greater than 0"):
        task_from_text(text.replace("joints: 4", "joints: 0"))
