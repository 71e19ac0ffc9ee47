"""How a limb will move that springs pull, the rest being held: its own equation of motion.

    M(q) q'' + c(q, q') + D q' = tau(q, q', t) + J^T f,      |tau| <= what the motors have

with MuJoCo's mass matrix and bias torques, in steps by the linearly implicit midpoint rule, which
stays stable where springs are stiff for the step. The ends of joints and what the limb leans on
push back (`sim/pushing_back.py`), but for what it is to pass through. Servos hold trunk and head,
which give way a little; other limbs are carried along. No step of the simulation is taken.
"""

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.body import Body
from sim.pushing_back import Stop, Stops, pushed_back
from sim.springs import JointSprings, Pull, Springs

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int32]

STEP, LONGEST = 0.006, 0.012  # [s]
FEWEST, MOST = 30, 400  # steps while the set point travels, unless they become longer than that
AT_REST = 0.03  # [rad/s] once the set point rests
FLUNG = 200.0  # [rad/s] which no limb is: then sight of it is lost


@dataclass(frozen=True)
class Foreseen:
    """How a limb moves in a given time."""

    travel: float  # time in which the set point travels [s]
    time: FloatArray  # (k,) [s]
    qpos: FloatArray  # (k, nq)
    # Of the joints `moved`, as shares of their limits: largest speed and largest torque that is
    # asked for (j,).
    speed: FloatArray
    torque: FloatArray
    leans: tuple[tuple[str, str], ...]  # links that lean on each other in the end
    at_end: IntArray  # joints (e,) that are in the end at an end of their range
    lost: bool  # whether it could not be foreseen to its end

    def between(self, first: float, last: float) -> FloatArray:
        """The postures (h, nq) from one time to another [s], both with it."""
        inner = (self.time > first) & (self.time < last)
        return np.vstack([self.at(first), self.qpos[inner], self.at(last)])

    def at(self, time: float) -> FloatArray:
        """The posture (nq,) at a time [s]; the last one, once it is over."""
        k = int(np.searchsorted(self.time, time, side="right"))
        if k >= len(self.time):
            last: FloatArray = self.qpos[-1]
            return last
        k = max(k, 1)
        part = (time - self.time[k - 1]) / (self.time[k] - self.time[k - 1])
        between: FloatArray = (1.0 - part) * self.qpos[k - 1] + part * self.qpos[k]
        return between


@dataclass(frozen=True)
class Foresight:
    """A movement that can be foreseen for any time that it is given."""

    body: Body
    dofs: IntArray  # that it moves
    start: FloatArray  # posture (nq,) in which it begins, at rest
    springs: Springs  # that move them; on the joints `moved`
    servos: JointSprings  # that held them before, and hold all others; on `moved`
    settling: float  # time in which the servos' set points travel [s]
    carried: bool  # whether something else carries the weight
    passed: frozenset[tuple[str, str]] = frozenset()  # pairs of links that go through each other

    def in_time(
        self,
        travel: float,
        until: float,
        hand_over: float,
        shy: frozenset[tuple[str, str]] = frozenset(),
    ) -> Foreseen:
        """How it goes.

        Args:
            travel: time in which the set point travels [s].
            until: how long it is looked at [s].
            hand_over: cross-fade from what held the joints before [s].
            shy: pairs of links that end it if they touch after the hand-over.
        """
        step = min(travel / FEWEST, max(STEP, min(LONGEST, travel / MOST)))
        limb, body, dofs = _Limb(self, step), self.body, moved(self.body, self.dofs)
        settled = max(travel, hand_over)
        times, postures = [0.0], [self.start.copy()]
        fastest, most = np.zeros((2, len(dofs)))
        lost = False
        while times[-1] < until:
            asked = limb.go_on(times[-1], travel, hand_over)
            lost = bool(np.abs(limb.speed).max() > FLUNG)
            if lost:
                break
            times.append(times[-1] + step)
            postures.append(limb.qpos)
            fastest, most = np.maximum(fastest, np.abs(limb.speed)), np.maximum(most, np.abs(asked))
            if times[-1] > settled and np.abs(limb.speed).max() < AT_REST:
                break
            if shy and times[-1] > hand_over and any(stop.links in shy for stop in limb.stops):
                break
        low, high = (limit[self.dofs] for limit in body.range)
        last = limb.qpos[body.qpos_of_dof[self.dofs]]
        leans = dict.fromkeys(stop.links for stop in limb.stops if stop.links is not None)
        return Foreseen(
            travel, np.array(times), np.array(postures), fastest / body.speed_limit[dofs],
            most / body.torque_limit[dofs], tuple(leans), self.dofs[(last <= low) | (last >= high)],
            lost,
        )  # fmt: skip


def moved(body: Body, dofs: IntArray) -> IntArray:
    """Some joints, and after them all others with a servo but those of limbs that keep still."""
    limbs = [body.joints(limb) for limb in body.map.limbs]
    still = [limb for limb in limbs if not np.isin(limb, dofs).any()]
    held = [
        dof for dof in np.flatnonzero(body.torque_limit > 0.0)
        if body.dof_name(int(dof)) in body.map.servos
    ]  # fmt: skip
    others = np.setdiff1d(held, np.concatenate([dofs, *still]))
    return np.concatenate([dofs, others]).astype(np.int32)


class _Limb:
    """A limb on its way."""

    def __init__(self, foresight: Foresight, step: float) -> None:
        body, dofs = foresight.body, moved(foresight.body, foresight.dofs)
        self._asked, self._step, self._dofs = foresight, step, dofs
        self._claimed = np.isin(dofs, foresight.dofs).astype(float)
        self._model, self._data = body.model, mujoco.MjData(body.model)
        self._columns = body.qpos_of_dof[dofs]
        self._own = np.ix_(dofs, dofs)
        self._whole, self._bias = np.zeros((body.nv, body.nv)), np.zeros(body.nv)
        damping = np.array(body.model.dof_damping, dtype=float).reshape(body.nv, -1)[:, 0]
        self._passive = np.diag(damping[dofs])
        self._limit = body.torque_limit[dofs]
        self._stops = Stops(body, dofs, foresight.passed)
        self._velocity, self._before = np.zeros((2, len(dofs)))
        self.qpos = foresight.start.copy()
        self.speed = self._velocity  # in the middle of the last step (j,) [rad/s]
        self.stops: list[Stop] = []  # what pushed back then

    def go_on(self, time: float, travel: float, hand_over: float) -> FloatArray:
        """Take one step, and say which torques (j,) the springs asked for [N m]."""
        half, old = 0.5 * self._step, self._velocity
        angles = self.qpos[self._columns]
        self._pose(angles + half * old)
        mass, weight, bias = self._dynamics(1.5 * old - 0.5 * self._before)
        pull, self.stops = self._pull(time + half, travel, hand_over), self._stops.found(self._data)
        borne = weight if self._asked.carried else np.zeros_like(weight)
        # In the middle of the step the joints are (half) x (middle - old) from where they were
        # looked at, and the springs are taken as linear from there on.
        torque = pull.torque + half * pull.stiffness @ old + borne
        slack = pull.damping + half * pull.stiffness
        square, right = mass / half + self._passive, mass @ old / half - bias

        def solved(slack: FloatArray, torque: FloatArray) -> FloatArray:
            free = np.asarray(np.linalg.solve(square + slack, right + torque), dtype=np.float64)
            return pushed_back(self.stops, square + slack, free, old, half)

        middle = solved(slack, torque)
        asked = torque - slack @ middle
        over = np.abs(asked) > self._limit
        if over.any():  # there the motor's limit acts in the place of the springs
            made = np.where(over, np.sign(asked) * self._limit, torque)
            middle = solved(np.where(over[:, None], 0.0, slack), made)
        self._before, self._velocity, self.speed = old, 2.0 * middle - old, middle
        self.qpos = self.qpos.copy()
        self.qpos[self._columns] = angles + self._step * middle
        return asked

    def _pose(self, angles: FloatArray) -> None:
        data = self._data
        data.qpos[:] = self.qpos
        data.qpos[self._columns] = angles
        mujoco.mj_kinematics(self._model, data)
        mujoco.mj_comPos(self._model, data)

    def _dynamics(self, velocity: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Mass matrix (j, j), weight and bias torques (j,), here."""
        model, data, dofs = self._model, self._data, self._dofs
        mujoco.mj_crb(model, data)
        mujoco.mj_fullM(model, data, self._whole)
        found = []
        for v in (0.0, velocity):
            data.qvel[:] = 0.0
            data.qvel[dofs] = v
            mujoco.mj_comVel(model, data)
            mujoco.mj_rne(model, data, 0, self._bias)
            found.append(self._bias[dofs])
        return self._whole[self._own], found[0], found[1]

    def _pull(self, time: float, travel: float, hand_over: float) -> Pull:
        pull = self._asked.springs.pull(self._data, time / travel, travel)
        share = _rise(time / hand_over) if time < hand_over else 1.0
        settling = self._asked.settling
        servos = self._asked.servos.pull(self._data, time / settling, settling)
        return pull.faded(share * self._claimed, servos)


def _rise(s: float) -> float:
    """The rise of an activation: Mataric et al. (1999), eq 5."""
    return float(s - np.sin(2.0 * np.pi * s) / (2.0 * np.pi))
