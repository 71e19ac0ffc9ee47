"""How far a limb lags behind a way that it is to go in a given time: dynamics, no simulation.

A way q(u), u being the share of the time T, takes the torques

    tau(u) = (M q'' + c(q, q')) / T^2 + D q' / T + g(q)

(the scaling of Hollerbach 1984, "Dynamic scaling of manipulator trajectories"), by MuJoCo's
mass matrix and bias torques. Springs make them only by lagging behind. About the way the lag
e = q - x is that of a linear system that varies with the time,

    M e" + (B + D) e' + K e = tau - g + (1 - a) (K (q - q_0) + B q' / T),

where a is the activation, which rises through the hand-over, and the motors' limits cut what
the springs ask for.
"""

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.body import Body
from sim.spring_way import Springs, passive_damping

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int32]

STEP = 0.004  # of the integration, which is implicit [s]
FEWEST = 40  # steps
LOST = np.pi  # [rad] of lag
WIDE = 3.0  # standard deviations to which a blur reaches


@dataclass(frozen=True)
class Lag:
    """What becomes of a way in a given time."""

    off: FloatArray  # (h, j) the lag from the end of the sub-task to that of the holding [rad]
    speed: FloatArray  # (j,) largest speed of each joint, as a share of its limit
    torque: FloatArray  # (j,) largest torque that the way takes, as a share of the motors' limits
    lost: bool  # whether it lags so far behind that nothing can be told without simulating


class Haste:
    """A way and what it takes, for any time that it is given.

    Args:
        body: whose way it is.
        dofs: the joints that move (j,).
        springs: along the way, at even shares of the time that the set point travels.
        carried: whether something else carries the weight.
        blur: the springs do not follow what is quicker than this on the way [s].
        rush: how much faster than foreseen the joints are which catch up.
    """

    def __init__(
        self,
        body: Body,
        dofs: IntArray,
        springs: Springs,
        *,
        carried: bool,
        blur: float = 0.0,
        rush: float = 1.0,
    ) -> None:
        self._body, self._dofs, self._springs = body, dofs, springs
        self._carried, self._blur, self._rush = carried, blur, rush
        self._limit = body.torque_limit[dofs]

    def in_time(self, travel: float, duration: float, hold: float, hand_over: float) -> Lag:
        """What becomes of it.

        Args:
            travel: time in which the set point travels [s].
            duration: of the sub-task, which may leave time to settle [s].
            hold: how long the goal is then held [s].
            hand_over: cross-fade from what held the joints before [s].
        """
        needs = self._needs(travel)
        steps = max(FEWEST, int(np.ceil((duration + hold) / STEP)))
        dt = (duration + hold) / steps
        e, rate = np.zeros((2, len(self._dofs)))
        kept, fastest, lost = [], np.zeros(len(self._dofs)), False
        for i in range(1, steps + 1):
            t = i * dt
            now = needs.at(t / travel)
            left = 1.0 - _rise(t / hand_over) if hand_over > 0.0 else 0.0
            rate = self._next_rate(now, e, rate, left, dt)
            e = e + dt * rate
            fastest = np.maximum(fastest, np.abs(now.speed - rate))
            lost = lost or bool(np.abs(e).max() > LOST)
            if t >= duration - 0.5 * dt:
                kept.append(e)
        speed = self._rush * fastest / self._body.speed_limit[self._dofs]
        share = np.abs(needs.torque).max(axis=0) / self._limit
        return Lag(np.array(kept), speed, share, lost)

    def _next_rate(
        self, now: "_Need", e: FloatArray, rate: FloatArray, left: float, dt: float
    ) -> FloatArray:
        """How fast the lag (j,) grows after a step, implicit in lag and rate [rad/s].

        Where the springs ask for more than a motor has, the motor's limit acts in their place.
        """
        held = left * (now.stiffness @ now.gone + now.damping @ now.speed)
        borne = now.weight if self._carried else np.zeros_like(e)
        need = now.push + now.drag @ now.speed + now.weight - borne
        inert = now.mass @ rate / dt + need
        square = now.mass / dt + now.drag
        new = _solved(square + now.damping + dt * now.stiffness, inert + held - now.stiffness @ e)
        asked = now.stiffness @ (e + dt * new) + now.damping @ new - held + borne
        over = np.abs(asked) > self._limit
        if not over.any():
            return new
        stiffness, damping = (np.where(over[:, None], 0.0, m) for m in (now.stiffness, now.damping))
        made = np.where(over, np.sign(asked) * self._limit - borne, -held)
        return _solved(square + damping + dt * stiffness, inert - made - stiffness @ e)

    def _needs(self, travel: float) -> "_Needs":
        """What the way takes in a time [s]."""
        body, dofs, springs = self._body, self._dofs, self._springs
        model, data, qpos = body.model, mujoco.MjData(body.model), springs.qpos.copy()
        columns, count = body.qpos_of_dof[dofs], len(qpos)
        angles = qpos[:, columns] = _blurred(qpos[:, columns], self._blur / travel * count)
        time = np.linspace(0.0, travel, count)
        speed = np.gradient(angles, time, axis=0, edge_order=2)
        acceleration = np.gradient(speed, time, axis=0, edge_order=2)
        mass, whole = np.zeros((count, len(dofs), len(dofs))), np.zeros((body.nv, body.nv))
        push, weight = np.zeros((2, count, len(dofs)))
        for k, q in enumerate(qpos):
            data.qpos[:], data.qvel[:] = q, 0.0
            mujoco.mj_fwdPosition(model, data)
            mujoco.mj_fwdVelocity(model, data)
            weight[k] = data.qfrc_bias[dofs]
            mujoco.mj_fullM(model, data, whole)
            mass[k] = whole[np.ix_(dofs, dofs)]
            data.qvel[dofs] = speed[k]
            mujoco.mj_fwdVelocity(model, data)
            push[k] = mass[k] @ acceleration[k] + data.qfrc_bias[dofs] - weight[k]
        passive = passive_damping(body, dofs)
        return _Needs(
            mass, push, weight, speed, angles - angles[0], push + speed @ passive + weight,
            springs.stiffness, springs.damping, springs.drag + passive,
        )  # fmt: skip


@dataclass(frozen=True)
class _Need:
    """What a way takes at one of its places, and the springs there."""

    mass: FloatArray  # (j, j) [kg m^2]
    push: FloatArray  # (j,) torque of inertia [N m]
    weight: FloatArray  # (j,) [N m]
    speed: FloatArray  # (j,) [rad/s]
    gone: FloatArray  # (j,) way from the start [rad]
    stiffness: FloatArray  # (j, j) [N m/rad]
    damping: FloatArray  # (j, j) of the difference from the wanted velocity [N m s/rad]
    drag: FloatArray  # (j, j) of the velocity itself [N m s/rad]


@dataclass(frozen=True)
class _Needs:
    """The same at all places (k, ...), and the torque (k, j) in all [N m]."""

    mass: FloatArray
    push: FloatArray
    weight: FloatArray
    speed: FloatArray
    gone: FloatArray
    torque: FloatArray
    stiffness: FloatArray
    damping: FloatArray
    drag: FloatArray

    def at(self, share: float) -> _Need:
        """At a share of the time; after it the set point rests."""
        place = min(share, 1.0) * (len(self.mass) - 1)
        k = min(int(place), len(self.mass) - 2)
        part = place - k
        moving = 1.0 if share < 1.0 else 0.0

        def mixed(values: FloatArray) -> FloatArray:
            between: FloatArray = (1.0 - part) * values[k] + part * values[k + 1]
            return between

        return _Need(
            mixed(self.mass), moving * mixed(self.push), mixed(self.weight),
            moving * mixed(self.speed), mixed(self.gone), mixed(self.stiffness),
            mixed(self.damping), mixed(self.drag),
        )  # fmt: skip


def _solved(square: FloatArray, right: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.solve(square, right), dtype=np.float64)


def _rise(s: float) -> float:
    """The rise of an activation: Mataric et al. (1999), eq 5."""
    return float(s - np.sin(2.0 * np.pi * s) / (2.0 * np.pi)) if s < 1.0 else 1.0


def _blurred(way: FloatArray, width: float) -> FloatArray:
    """A way (k, j) without what is quicker than so many of its rows."""
    reach = int(np.ceil(WIDE * width))
    if reach < 1:
        return way
    bell = np.exp(-0.5 * (np.arange(-reach, reach + 1) / width) ** 2)
    padded = np.pad(way, ((reach, reach), (0, 0)), mode="edge")
    smooth = [np.convolve(column, bell / bell.sum(), mode="valid") for column in padded.T]
    blurred: FloatArray = np.stack(smooth, axis=1)
    return blurred
