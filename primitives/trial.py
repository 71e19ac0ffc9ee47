"""A trial: a primitive on a body, and the states in which the conformance kit tries it."""

from functools import cached_property

import numpy as np

from primitives.compensate_gravity import CompensateGravity
from primitives.primitive import BoolArray, Field, FloatArray, Primitive
from sim import Body, Servo, State, World, adonis

SETTLING = 4.0  # time in which a field must bring an undisturbed body to its goal [s]


class Trial:
    """A primitive on a body, and the states in which it is tried.

    Args:
        primitive: what is tried.
        body: on which; default: Adonis.
        duration: time that it is given [s].
        goal_error: how near its goal it must come, in its own unit.
        seed: of the random states.
    """

    def __init__(
        self,
        primitive: Primitive,
        body: Body | None = None,
        *,
        duration: float = 0.6,
        goal_error: float = 0.02,
        seed: int = 0,
    ) -> None:
        self.primitive = primitive
        self.body = adonis() if body is None else body
        self.duration, self.goal_error, self.seed = duration, goal_error, seed

    def bind(self) -> Field:
        """A fresh field."""
        return self.primitive.bind(self.body, self.duration)

    def begun(self, state: State) -> Field:
        """A fresh field that was switched on in every simulation of a state."""
        field = self.bind()
        field.begin(state, np.ones(state.n, dtype=np.bool_))
        return field

    def postures(self, n: int, *, spread: float = 0.3) -> FloatArray:
        """Random postures (n, nq) around home, within the joint limits."""
        rng = np.random.default_rng(self.seed)
        body = self.body
        angles = body.home[body.qpos_of_dof] + rng.normal(0.0, spread, (n, body.nv))
        low, high = body.range
        qpos = np.tile(body.home, (n, 1))
        qpos[:, body.qpos_of_dof] = np.clip(angles, low, high)
        return qpos

    def velocities(self, n: int, *, spread: float = 1.0) -> FloatArray:
        """Random velocities (n, nv)."""
        return np.random.default_rng(self.seed + 1).normal(0.0, spread, (n, self.body.nv))

    def state(self, qpos: FloatArray, qvel: FloatArray | None = None) -> State:
        """The state of postures (n, nq), at rest or moving with velocities (n, nv)."""
        world = World(self.body, len(qpos))
        world.reset(qpos, qvel)
        return world.state

    def free(self, field: Field) -> BoolArray:
        """Which joints (nv,) the field moves: those it claims, or all if it claims none."""
        mask = np.zeros(self.body.nv, dtype=np.bool_)
        mask[field.claims if len(field.claims) else slice(None)] = True
        return mask

    @cached_property
    def settled(self) -> tuple[FloatArray, Field]:
        """Where the field brings the body (n, nq) when nothing is in its way, and the field.

        Gravity is carried, the joints that the field does not claim are held, and all joints are
        damped a little.
        """
        start = self.postures(4, spread=0.1)
        world = World(self.body, len(start))
        world.reset(start)
        field = self.begun(world.state)
        held = Held(self.body, self.free(field), world.state)
        for _ in range(int(SETTLING / self.body.timestep)):
            t = world.state.time.copy()
            world.step(held.torque(world.state, damped=0.3) + field.torque(world.state, t))
        return world.state.qpos.copy(), field


class Held:
    """What keeps a body up and the joints still that a field does not claim."""

    def __init__(self, body: Body, free: BoolArray, state: State) -> None:
        loose = Servo(stiffness=1e-9, damping=0.0)  # a joint of which the body map says nothing
        servos = [body.map.servos.get(body.dof_name(dof), loose) for dof in range(body.nv)]
        self._columns = body.qpos_of_dof
        self._stiffness = np.where(free, 0.0, [s.stiffness for s in servos])
        self._damping = np.array([s.damping for s in servos])
        self._free = free
        self._start = state.qpos[:, self._columns].copy()
        self._weight = CompensateGravity().bind(body, np.inf)

    def torque(self, state: State, *, damped: float = 0.0) -> FloatArray:
        """Torques (n, nv); `damped` is the share of a servo's damping on the free joints."""
        damping = self._damping * np.where(self._free, damped, 1.0)
        spring = self._stiffness * (self._start - state.qpos[:, self._columns])
        weight = self._weight.torque(state, np.zeros(state.n))
        held: FloatArray = weight + spring - damping * state.qvel
        return held
