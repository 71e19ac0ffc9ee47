"""Wanted movements as sums of fields: what the weights promise, and what the physics then does."""

from dataclasses import replace

import numpy as np
import pytest

from adonis.comparison.superposition import (
    Choice,
    Superposition,
    System,
    Wells,
    draw_wells,
    fit,
    linear_system,
    simulate,
    star,
    study,
    superpose,
    systems,
    time_courses,
)
from adonis.comparison.superposition_figure import draw_superposition
from sim import BodyError, World, inverse_dynamics, planar_arm, site_paths

ONE = np.ones(1, dtype=bool)


@pytest.fixture(scope="module")
def planar() -> System:
    return systems()[0]


@pytest.fixture(scope="module")
def right_arm() -> System:
    return systems()[1]


def made_of(system: System, choice: Choice):
    """The motion, the fields, their fit, and the field that it makes."""
    motion, dofs = system.motion(), system.dofs
    wells = draw_wells(system.body, motion, dofs, choice)
    found = fit(system.body, motion, dofs, wells, pulses=choice.pulses)
    goal = motion.qpos[-1][dofs]
    field = Superposition(system.body, dofs, wells, found.weights, motion.duration, goal)
    return motion, wells, found, field


# --- what is wanted -------------------------------------------------------------------------


def test_the_planar_arm_is_adonis_arm_and_feels_no_weight() -> None:
    body = planar_arm()
    hand = site_paths(body, ("hand",), np.zeros((1, 2)))[0, 0]
    np.testing.assert_allclose(hand, [0.0, -(0.2817 + 0.2689 + 0.1879), 0.0], atol=1e-12)
    assert body.model.body_mass.sum() == pytest.approx(1.978 + 1.183 + 0.445)
    q = np.deg2rad([[20.0, 60.0], [90.0, 10.0]])
    torque, weight = inverse_dynamics(body, q, np.zeros((2, 2)), np.zeros((2, 2)))
    np.testing.assert_allclose(weight, 0.0, atol=1e-9)
    np.testing.assert_allclose(torque, 0.0, atol=1e-9)
    with pytest.raises(BodyError, match="unknown joint"):
        body.joints("wrist")


@pytest.mark.parametrize("k", [0, 1, 2])
def test_the_wanted_motion_is_straight_and_minimum_jerk(k: int) -> None:
    system = systems()[k]
    motion = system.motion()
    paths = site_paths(system.body, tuple(system.moves), motion.qpos)
    s = np.clip(motion.time / system.duration, 0, 1)
    share = 10 * s**3 - 15 * s**4 + 6 * s**5
    for path, (start, end) in zip(paths, motion.line, strict=True):
        np.testing.assert_allclose(path, start + share[:, None] * (end - start), atol=1e-4)
        speed = np.linalg.norm(np.gradient(path, motion.time, axis=0), axis=1)
        length = np.linalg.norm(end - start)
        assert speed.max() == pytest.approx(1.875 * length / system.duration, rel=5e-3)
    np.testing.assert_allclose(
        np.gradient(motion.qpos, motion.time, axis=0)[1:-1], motion.qvel[1:-1], atol=2e-3
    )


def test_the_wanted_torques_alone_make_the_wanted_motion(planar: System) -> None:
    """Inverse dynamics and the simulation are of the same physics."""
    motion, world = planar.motion(), World(planar.body)
    for torque, q in zip(motion.torque, motion.qpos, strict=True):
        assert np.abs(world.state.qpos[0] - q).max() < 0.01
        world.step(torque[None])


def test_a_line_out_of_reach_is_refused(planar: System) -> None:
    with pytest.raises(BodyError, match="cannot follow the line"):
        replace(planar, moves={"hand": (0.5, 0.0, 0.0)}).motion()
    with pytest.raises(BodyError, match="takes shoulder beyond its range"):
        replace(planar, moves={"hand": (-0.33, -0.08, 0.0)}).motion()


# --- the weights ----------------------------------------------------------------------------


@pytest.mark.parametrize("coupled", [False, True])
def test_the_linear_system_is_the_field_that_runs(right_arm: System, coupled: bool) -> None:
    motion, wells, found, field = made_of(right_arm, Choice(12, coupled))
    body, dofs = right_arm.body, right_arm.dofs
    damping = np.array([body.servo(int(d)).damping for d in dofs])
    rows = np.array([0, 37, 160, 250, 400, 500, 640])
    q, v, t = motion.qpos[rows], motion.qvel[rows], motion.time[rows]
    world = World(body, len(rows))
    world.reset(np.tile(motion.qpos[0], (len(rows), 1)))
    field.begin(world.state, np.ones(len(rows), dtype=bool))
    state = replace(world.state, qpos=q, qvel=v)
    courses = time_courses(t / motion.duration)
    matrix = linear_system(wells, courses, q[:, dofs])
    made = (matrix @ found.weights.ravel()).reshape(len(rows), -1)
    made += (1 - courses[0])[:, None] * wells.pull(q[:, dofs] - motion.qpos[0, dofs])
    torque = field.torque(state, t)
    np.testing.assert_allclose(torque[:, dofs], made - damping * v[:, dofs], atol=1e-9)
    np.testing.assert_array_equal(np.delete(torque, dofs, axis=1), 0.0)
    assert field.error(state)[-1] == pytest.approx(0.0, abs=1e-12)


def test_a_well_is_equation_3_or_its_coupled_form() -> None:
    e = np.array([[[0.3, -0.8]]])
    k, s = np.array([20.0, 5.0]), np.array([0.5, 0.5])
    alone, coupled = (Wells(np.zeros((1, 2)), k, s, form).torque(e[0]) for form in (False, True))
    np.testing.assert_allclose(alone, -k * e * np.exp(-(e**2) / (2 * s**2)))
    np.testing.assert_allclose(coupled, -k * e * np.exp(-(e**2).sum() / (2 * 0.25)))


def test_time_courses_are_equations_5_and_6() -> None:
    s = np.linspace(-0.2, 1.2, 701)
    w, v, *short = time_courses(s, 6)
    inside = np.clip(s, 0, 1)
    np.testing.assert_allclose(w, inside - np.sin(2 * np.pi * inside) / (2 * np.pi), atol=1e-12)
    np.testing.assert_allclose(v, np.gradient(w, s), atol=1e-3)
    assert len(short) == 5
    for k, course in enumerate(short):
        on = s[course > 0]
        assert on.min() >= k / 6
        assert on.max() <= (k + 2) / 6
        assert course.max() == pytest.approx(2.0, abs=1e-3)


@pytest.mark.parametrize("coupled", [False, True])
@pytest.mark.parametrize("k", [0, 1, 2])
def test_weights_are_not_negative_and_more_fields_fit_better(k: int, coupled: bool) -> None:
    system = systems()[k]
    motion = system.motion()
    residuals = []
    for count in (4, 8, 16, 32):
        wells = draw_wells(system.body, motion, system.dofs, Choice(count, coupled))
        found = fit(system.body, motion, system.dofs, wells)
        assert (found.weights >= 0).all()
        assert 0 < found.used <= count
        assert found.misfit < 1.0
        residuals.append(found.residual)
    assert (np.diff(residuals) <= 1e-9).all()
    assert residuals[-1] < 0.8 * residuals[0]


# --- the physics ----------------------------------------------------------------------------


@pytest.mark.parametrize("seed", [0, 1])
def test_the_planar_hand_stays_within_a_centimetre_of_the_line(seed: int) -> None:
    for run in star(Choice(16, seed=seed)):
        assert run.deviation < 0.005
        assert run.end_error < 0.005
        assert run.peak < 1.0


@pytest.mark.parametrize("duration", [0.4, 1.5])
def test_fast_or_slow_the_planar_hand_follows_line_and_timing(planar, duration: float) -> None:
    system = replace(planar, duration=duration)
    motion, _, _, field = made_of(system, Choice(16, coupled=True))
    run = simulate(system, motion, field)
    start, end = run.lines[0]
    s = np.clip(motion.time / duration, 0, 1)
    wanted = start + (10 * s**3 - 15 * s**4 + 6 * s**5)[:, None] * (end - start)
    assert run.deviation < 0.01
    assert np.linalg.norm(run.paths[0] - wanted, axis=1).max() < 0.01


def test_without_weights_the_hand_stays_where_it_is(planar: System) -> None:
    motion, wells, found, _ = made_of(planar, Choice(4))
    goal = motion.qpos[-1]
    field = Superposition(planar.body, planar.dofs, wells, 0 * found.weights, 0.8, goal)
    run = simulate(planar, motion, field)
    assert run.end_error == pytest.approx(0.25, abs=1e-6)


def test_seven_joints_follow_their_line_too(right_arm: System) -> None:
    row, run = superpose(right_arm, Choice(32))
    assert row.dof == 7
    assert row.deviation == run.deviation < 0.01
    assert row.end_error < 0.005


def test_the_study_has_a_row_for_each_case_and_can_be_drawn(tmp_path) -> None:
    told = []
    rows = study(counts=(4, 8), seeds=(0,), progress=lambda *say: told.append(say))
    assert len(rows) == len(told) == 3 * (2 * 2 + 2)
    assert {(row.body, row.dof) for row in rows} == {
        ("planar arm", 2),
        ("right arm", 7),
        ("Adonis", 20),
    }
    assert rows[0].fields == 4
    draw_superposition(rows, star(Choice(8), ways=2), tmp_path / "s.png")
    assert (tmp_path / "s.png").stat().st_size > 10_000
