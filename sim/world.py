"""The physics: n simulations of a body, stepped together."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import mujoco
import mujoco.batch
import numpy as np
from numpy.typing import NDArray

from sim.body import Body
from sim.carrying import Carried, Objects
from sim.errors import BodyError, Diverged, unknown
from sim.state import State, read_only

FloatArray = NDArray[np.float64]
_KINEMATICS = mujoco.mjtStage.mjSTAGE_VEL.value


@dataclass(frozen=True)
class Push:
    """A force on a link for a while, in some of the simulations."""

    link: str
    force: tuple[float, float, float]  # [N] in world axes, at the link's centre of mass
    start: float  # [s]
    duration: float  # [s]
    simulations: tuple[int, ...] | None = None  # all of them when None


@dataclass(frozen=True)
class Moment:
    """One simulation as it is now: what its future follows from, but for the torques to come."""

    time: float  # [s]
    qpos: FloatArray  # (nq,)
    qvel: FloatArray  # (nv,)
    warmstart: FloatArray  # (nv,) where the solver of the contacts begins
    objects: Carried | None = None  # of the scene


class BareWorld:
    """MuJoCo's `Batch` and nothing else: what control is measured against.

    Args:
        body: what is simulated.
        n: how many simulations.
        threads: how many threads step them.
        start: posture (nq,) of all of them.
    """

    def __init__(self, body: Body, n: int, threads: int, start: FloatArray) -> None:
        self._batch = mujoco.batch.Batch(body.model, n, threads, persistent=True)
        self._batch.bind("qpos")[:] = start
        self._ctrl = self._batch.bind("ctrl")

    def step(self, ctrl: FloatArray) -> None:
        """Apply the same motor torques (nu,) [N m] in all simulations for one step."""
        self._ctrl[:] = ctrl
        self._batch.step()


class World:
    """n simulations of one body over `mujoco.batch.Batch`.

    Args:
        body: what is simulated.
        n: how many simulations.
        threads: how many threads step them; the results do not depend on it.
        pushes: forces from outside.
        inertia: whether `state.M` is kept.

    Raises:
        BodyError: a push names a link that the body lacks.
    """

    def __init__(
        self,
        body: Body,
        n: int = 1,
        *,
        threads: int = 1,
        pushes: Sequence[Push] = (),
        inertia: bool = False,
    ) -> None:
        if n < 1 or threads < 1:
            raise BodyError(f"a world needs n >= 1 and threads >= 1, not n={n}, threads={threads}")
        self.body = body
        self.n = n
        self.threads = threads
        batch = mujoco.batch.Batch(body.model, n, threads, persistent=True)
        self._batch = batch
        self._ctrl = batch.bind("ctrl")
        self._motors = body.motor_dofs
        self._direct = np.array_equal(self._motors, np.arange(body.nv))
        self._pushes = [(p, body.link(p.link)) for p in pushes]
        self._force = batch.bind("xfrc_applied") if pushes else None
        self._qpos, self._qvel = batch.bind("qpos"), batch.bind("qvel")
        self._time, self._warmstart = batch.bind("time"), batch.bind("qacc_warmstart")
        live = self._time, self._qpos, self._qvel
        seen = [np.ascontiguousarray(array) for array in live]
        self._copies = [(a, b) for a, b in zip(seen, live, strict=True) if a is not b]
        self._objects = Objects(body, batch) if len(body.objects) else None
        cvel = batch.bind("cvel")
        self._cvel = np.array(cvel) if self._objects is not None else cvel
        if self._objects is not None:
            self._copies.append((self._cvel, cvel))
        time, qpos, qvel = (read_only(array.view()) for array in seen)
        self.state = State(
            time=time,
            qpos=qpos,
            qvel=qvel,
            xpos=read_only(batch.bind("xpos").view()),
            xmat=read_only(batch.bind("xmat").view()),
            cdof=read_only(batch.bind("cdof").view()),
            cvel=read_only(self._cvel.view()),
            subtree_com=read_only(batch.bind("subtree_com").view()),
            qfrc_bias=read_only(batch.bind("qfrc_bias").view()),
            M=read_only(batch.bind("M").view()) if inertia else None,
        )
        self.reset()

    def reset(self, qpos: FloatArray | None = None, qvel: FloatArray | None = None) -> None:
        """Begin anew at time 0, in all simulations.

        Args:
            qpos: posture (nq,) or (n, nq); default: home.
            qvel: velocities (nv,) or (n, nv); default: at rest.
        """
        self._batch.reset(stage=mujoco.mjtStage.mjSTAGE_NONE.value)
        self._qpos[:] = self.body.home if qpos is None else qpos
        self._qvel[:] = 0.0 if qvel is None else qvel
        if self._objects is not None:
            self._objects.rest()
        self._batch.forward(stage=_KINEMATICS)
        self._look()

    def moment(self, simulation: int = 0) -> Moment:
        """One of the simulations as it is now."""
        state, warmstart = self.state.of_one(simulation), self._warmstart[simulation]
        return Moment(
            float(state.time[0]), state.qpos[0].copy(), state.qvel[0].copy(), warmstart.copy(),
            None if self._objects is None else self._objects.of(simulation),
        )  # fmt: skip

    def go_back(self, moment: Moment) -> None:
        """Let all simulations go on from a moment of this world or of another of its body."""
        self._time[:], self._warmstart[:] = moment.time, moment.warmstart
        self._qpos[:], self._qvel[:] = moment.qpos, moment.qvel
        if self._objects is not None and moment.objects is not None:
            self._objects.put(moment.objects)
        self._batch.forward(stage=_KINEMATICS)
        self._look()

    def step(self, torque: FloatArray) -> None:
        """Apply joint torques (n, nv) [N m] for one time step and bring `state` up to date.

        The motors of the model limit what is applied; see `torque` for what was.
        """
        if self._direct:
            self._ctrl[:] = torque
        else:
            self._ctrl[:] = torque[:, self._motors]
        if self._force is not None:
            self._push(self._force)
        time = float(self.state.time[0])
        if self._objects is not None and self._objects.ahead(time):
            # Set between the two calls, so that kinematics are worked out once.
            self._batch.step(stage=mujoco.mjtStage.mjSTAGE_NONE.value)
            self._objects.go_on(time)
            self._batch.forward(stage=_KINEMATICS)
        else:
            self._batch.step(stage=_KINEMATICS)
            if self._objects is not None:
                self._objects.rest()
        self._look()

    def carry(
        self,
        name: str,
        place: FloatArray | tuple[float, float, float],
        speed: FloatArray | tuple[float, float, float] = (0.0, 0.0, 0.0),
    ) -> None:
        """Put an object of the scene somewhere; it is there after the next step, and stays.

        Args:
            name: of the object.
            place: of its middle, (3,) or (n, 3) [m].
            speed: that it then has, (3,) or (n, 3) [m/s], until the step after: what follows it
                goes by that.

        Raises:
            BodyError: there is no such object, or its task carries it.
        """
        if self._objects is None:
            raise BodyError(unknown("object of the scene", name, ()))
        self._objects.carry(name, place, speed)

    @cached_property
    def torque(self) -> FloatArray:
        """The torques (n, nv) [N m] that the motors applied in the last step: a live view.

        It is copied out of the physics from the first time that it is asked for, and shows
        zeros until the step after that.
        """
        applied: FloatArray = self._batch.bind("qfrc_actuator")
        return applied

    def check(self) -> None:
        """Raise `Diverged` if the physics of any simulation has gone wrong.

        Raises:
            Diverged: with the simulation, the time, and MuJoCo's own warning.
        """
        warned = self._batch.warning[:, :, 1]  # how often each kind was raised
        finite = np.isfinite(self.state.qvel).all(axis=1) & np.isfinite(self.state.qpos).all(axis=1)
        bad = np.flatnonzero(warned.any(axis=1) | ~finite)
        if bad.size:
            i = int(bad[0])
            kinds = [mujoco.mjtWarning(int(k)).name for k in np.flatnonzero(warned[i])]
            what = ", ".join(k.removeprefix("mjWARN_").lower() for k in kinds) or "not finite"
            raise Diverged(
                f"simulation {i} went wrong at {self.state.time[i]:.3f} s (MuJoCo: {what})"
            )

    def _look(self) -> None:
        """Bring the times, positions and velocities of `state` up to date.

        MuJoCo keeps those of many simulations in rows of something larger. To compiled code that
        is another type than the arrays of one simulation, and all of it would be compiled twice.
        """
        for seen, live in self._copies:
            seen[:] = live
        if self._objects is not None:
            self._objects.show(self._cvel)

    def _push(self, force: FloatArray) -> None:
        force[:] = 0.0
        for push, link in self._pushes:
            on = (self.state.time >= push.start) & (self.state.time < push.start + push.duration)
            if push.simulations is not None:
                chosen = np.zeros(self.n, dtype=bool)
                chosen[list(push.simulations)] = True
                on &= chosen
            force[on, link, :3] += push.force
