"""How far a limb lags behind a way that it is to go in a given time: dynamics, no simulation.

A way q(u), u being the share of the time T, takes the torques

    tau(u) = (M q'' + c(q, q')) / T^2 + D q' / T + g(q)

(the scaling of Hollerbach 1984, "Dynamic scaling of manipulator trajectories"), by MuJoCo's
inverse dynamics. Springs make them only by lagging behind. About the way the lag e = q - x is
that of a linear system that varies with the time,

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
LOST = np.pi  # [rad] of lag


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
        rush: how much faster than that the joints are which catch up.
    """

    def __init__(
        self, body: Body, dofs: IntArray, springs: Springs, *, carried: bool, blur: float = 0.0, rush: float = 1.0,
    ) -> None:  # fmt: skip
        self._body, self._dofs, self._springs = body, dofs, springs
        self._carried, self._blur, self._rush = carried, blur, rush

    def in_time(self, travel: float, duration: float, hold: float, hand_over: float) -> Lag:
        """What becomes of it.

        Args:
            travel: time in which the set point travels [s].
            duration: of the sub-task, which may leave time to settle [s].
            hold: how long the goal is then held [s].
            hand_over: cross-fade from what held the joints before [s].
        """
        parts, s = self._parts(travel), self._springs
        last = len(s.qpos) - 1
        steps = max(40, int(np.ceil((duration + hold) / STEP)))
        dt = (duration + hold) / steps
        count = len(self._dofs)
        e, rate = np.zeros(count), np.zeros(count)
        limit = self._body.torque_limit[self._dofs]
        kept, fastest, lost = [], np.zeros(count), False
        for i in range(1, steps + 1):
            t = i * dt
            at = min(t / travel, 1.0) * last
            k = min(int(at), last - 1)
            part = at - k

            def now(values: FloatArray, k: int = k, part: float = part) -> FloatArray:
                mixed: FloatArray = (1.0 - part) * values[k] + part * values[k + 1]
                return mixed

            moving = t < travel
            speed = now(parts.speed) / travel if moving else np.zeros(count)
            stiffness, damping, drag = now(s.stiffness), now(s.damping), now(parts.drag)
            weight, mass = now(parts.weight), now(parts.mass)
            need = drag @ speed + (0.0 if self._carried else 1.0) * weight
            if moving:
                need = need + now(parts.push) / travel**2
            left = 1.0 - _step(t / hand_over) if hand_over > 0.0 else 0.0
            held = left * (stiffness @ now(parts.gone) + damping @ speed)
            borne = weight if self._carried else np.zeros(count)
            # Implicit: M (rate+ - rate) / dt = need - drag rate+ - applied(e + dt rate+, rate+)
            spring, damper = stiffness, damping
            fixed = np.zeros(count)
            for _ in range(2):
                square = mass / dt + drag + damper + dt * spring
                right = mass @ rate / dt + need - spring @ e - fixed
                free = spring.any(axis=1) | damper.any(axis=1)
                new = np.linalg.solve(square, right + np.where(free, held, 0.0))
                asked = stiffness @ (e + dt * new) + damping @ new - held + borne
                over = np.abs(asked) > limit
                if not over.any():
                    break
                spring, damper = np.where(over[:, None], 0.0, stiffness), np.where(
                    over[:, None], 0.0, damping
                )
                fixed = np.where(over, np.sign(asked) * limit - borne, 0.0)
            rate = new
            e = e + dt * rate
            fastest = np.maximum(fastest, np.abs(speed - rate))
            lost = lost or bool(np.abs(e).max() > LOST)
            if t >= duration - 0.5 * dt:
                kept.append(e)
        speed_limit = self._body.speed_limit[self._dofs]
        return Lag(np.array(kept), self._rush * fastest / speed_limit, self._torque(parts, travel), lost)

    def _torque(self, parts: "_Parts", travel: float) -> FloatArray:
        """Largest torque (j,) that the way takes in a time [s], as a share of the limits."""
        limit = self._body.torque_limit[self._dofs]
        own = np.einsum("kij,kj->ki", parts.passive, parts.speed)
        whole = parts.push / travel**2 + own / travel + parts.weight
        share: FloatArray = np.abs(whole).max(axis=0) / np.where(limit > 0.0, limit, np.inf)
        return share

    def _parts(self, travel: float) -> "_Parts":
        body, dofs, qpos = self._body, self._dofs, self._springs.qpos.copy()
        model, data = body.model, mujoco.MjData(body.model)
        columns = body.qpos_of_dof[dofs]
        share = np.linspace(0.0, 1.0, len(qpos))
        angles = qpos[:, columns] = _blurred(qpos[:, columns], self._blur / travel * len(qpos))
        first = np.gradient(angles, share, axis=0, edge_order=2)
        second = np.gradient(first, share, axis=0, edge_order=2)
        count = len(dofs)
        mass, push = np.zeros((len(qpos), count, count)), np.zeros((len(qpos), count))
        weight, whole = np.zeros((len(qpos), count)), np.zeros((body.nv, body.nv))
        passive = passive_damping(body, dofs)
        for k, q in enumerate(qpos):
            data.qpos[:], data.qvel[:] = q, 0.0
            mujoco.mj_fwdPosition(model, data)
            mujoco.mj_fwdVelocity(model, data)
            weight[k] = data.qfrc_bias[dofs]
            mujoco.mj_fullM(model, data, whole)
            mass[k] = whole[np.ix_(dofs, dofs)]
            data.qvel[dofs] = first[k]
            mujoco.mj_fwdVelocity(model, data)
            push[k] = mass[k] @ second[k] + data.qfrc_bias[dofs] - weight[k]
        return _Parts(
            mass=mass, push=push, weight=weight, speed=first, gone=angles - angles[0],
            passive=np.tile(passive, (len(qpos), 1, 1)), drag=self._springs.drag + passive,
        )  # fmt: skip


@dataclass(frozen=True)
class _Parts:
    """Along the way, for a time of one second."""

    mass: FloatArray  # (k, j, j) [kg m^2]
    push: FloatArray  # (k, j) torque of inertia [N m s^2]
    weight: FloatArray  # (k, j) [N m]
    speed: FloatArray  # (k, j) [rad]
    gone: FloatArray  # (k, j) way from the start [rad]
    passive: FloatArray  # (k, j, j) damping of the joints themselves [N m s/rad]
    drag: FloatArray  # (k, j, j) with what the springs add


def _step(s: float) -> float:
    """The rise of an activation: Mataric et al. (1999), eq 5."""
    return min(max(s, 0.0), 1.0) if not 0.0 < s < 1.0 else s - np.sin(2.0 * np.pi * s) / (2 * np.pi)


def _blurred(way: FloatArray, width: float) -> FloatArray:
    """A way (k, j) without what is quicker than some of its rows; its ends stay."""
    reach = int(np.ceil(3.0 * width))
    if reach < 1 or width < 0.1:
        return way
    bell = np.exp(-0.5 * (np.arange(-reach, reach + 1) / width) ** 2)
    padded = np.pad(way, ((reach, reach), (0, 0)), mode="edge")
    smooth = [np.convolve(column, bell / bell.sum(), mode="valid") for column in padded.T]
    blurred: FloatArray = np.stack(smooth, axis=1)
    return blurred
