"""The physics: the same alone and in a batch, at any number of threads."""

from dataclasses import fields

import mujoco
import numpy as np
import pytest
from numba import typeof

from sim import Body, BodyError, Diverged, Push, State, World


def swing(body: Body, n: int, threads: int, steps: int = 60) -> np.ndarray:
    world = World(body, n, threads=threads)
    start = np.tile(body.home, (n, 1))
    start[:, body.qpos_of_dof[body.joints("right_elbow")]] += 0.1 * np.arange(n)[:, None] / n
    world.reset(start)
    for _ in range(steps):
        world.step(-0.5 * world.state.qvel)
    return np.array(world.state.qpos)


def test_a_batch_is_bit_for_bit_its_simulations_at_any_number_of_threads(body: Body) -> None:
    together = swing(body, 8, 1)
    np.testing.assert_array_equal(together, swing(body, 8, 2))
    plain = mujoco.MjData(body.model)
    plain.qpos[:] = body.home
    for _ in range(60):
        mujoco.mj_step1(body.model, plain)
        plain.ctrl[:] = -0.5 * plain.qvel
        mujoco.mj_step2(body.model, plain)
    np.testing.assert_array_equal(together[0], plain.qpos)


def test_state_is_that_of_plain_mujoco(body: Body) -> None:
    world = World(body, 2)
    rng = np.random.default_rng(0)
    world.reset(body.home + 0.1 * rng.standard_normal((2, body.nv)))
    for _ in range(5):
        world.step(np.zeros((2, body.nv)))
    data = mujoco.MjData(body.model)
    data.qpos[:], data.qvel[:] = world.state.qpos[1], world.state.qvel[1]
    mujoco.mj_forward(body.model, data)
    one = State.of(data)
    assert one.n == 1
    for name in ("xpos", "xmat", "cdof", "cvel", "subtree_com", "qfrc_bias"):
        np.testing.assert_allclose(
            getattr(world.state, name)[1], getattr(one, name)[0], atol=1e-12, err_msg=name
        )


def test_a_push_moves_the_simulation_it_is_meant_for_while_it_lasts(body: Body) -> None:
    push = Push("right_hand", (0.0, -40.0, 0.0), 0.02, 0.1, (1,))
    world = World(body, 2, pushes=[push])
    apart = []
    for _ in range(80):
        world.step(np.zeros((2, body.nv)))
        apart.append(np.abs(world.state.qvel[1] - world.state.qvel[0]).max())
    assert max(apart[:10]) == 0.0
    assert apart[30] > 1.0
    assert apart[79] < max(apart), "it ends"


def test_a_push_on_a_link_that_does_not_exist_is_refused(body: Body) -> None:
    with pytest.raises(BodyError, match="unknown link 'foot'"):
        World(body, pushes=[Push("foot", (1.0, 0.0, 0.0), 0.0, 0.1)])


def test_physics_that_goes_wrong_is_noticed(body: Body) -> None:
    world = World(body, 3)
    world.check()
    velocity = np.zeros((3, body.nv))
    velocity[1] = np.inf
    world.reset(qvel=velocity)
    world.step(np.zeros((3, body.nv)))
    with pytest.raises(Diverged, match="simulation 1"):
        world.check()


@pytest.mark.parametrize("size", [{"n": 0}, {"n": 1, "threads": 0}])
def test_a_world_needs_simulations_and_threads(body: Body, size) -> None:
    with pytest.raises(BodyError):
        World(body, **size)


def test_what_a_primitive_sees_cannot_be_written(body: Body) -> None:
    """However the state was made, and whatever part of it is looked at."""
    world, data = World(body, 3, inertia=True), mujoco.MjData(body.model)
    mujoco.mj_forward(body.model, data)
    for state in (world.state, world.state.of_one(1), State.of(data)):
        for field in fields(state):
            with pytest.raises(ValueError, match="read-only"):
                getattr(state, field.name)[:] = 0.0
    velocity = np.full(body.nv, 0.5)
    world.reset(qvel=velocity)
    np.testing.assert_array_equal(world.state.qvel, np.tile(velocity, (3, 1)))
    np.testing.assert_array_equal(world.state.qpos, np.tile(body.home, (3, 1)))


def test_compiled_code_sees_the_same_types_however_a_state_was_made(body: Body) -> None:
    """Else a loop of one's own would compile everything anew, for many seconds."""
    data = mujoco.MjData(body.model)
    mujoco.mj_forward(body.model, data)
    ours, many = World(body, inertia=True).state, World(body, 4, inertia=True).state
    states = (ours, many, many.of_one(2), State.of(data))
    for field in fields(State):
        kinds = {typeof(getattr(state, field.name)) for state in states}
        assert len(kinds) == 1, f"{field.name}: {kinds}"
