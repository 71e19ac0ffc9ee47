"""Wanted movements: hands on straight lines, and the joint torques that they take.

The hands move on straight lines with the minimum-jerk profile (Flash & Hogan 1985) and then
rest. The joints follow by inverse kinematics, their velocities and accelerations by the chain
rule, and the torques by inverse dynamics.
"""

import copy
from collections.abc import Mapping
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.polynomial import Chebyshev
from numpy.typing import NDArray

from sim.body import Body
from sim.errors import BodyError

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int32]

NODES = 41  # places on the line for which the joint angles are found
DEGREE = 14  # of the polynomials through them
NEAR = 1e-6  # by how much a hand may miss those places [m]
ITERATIONS = 50
DAMPING = 1e-9  # of the least squares, for lines that touch the rim of the reach


@dataclass(frozen=True)
class Motion:
    """A movement of the whole body, at the times of the simulation's steps."""

    duration: float  # of the movement; what follows is rest [s]
    time: FloatArray  # (T,) [s]
    qpos: FloatArray  # (T, nv) joint angles [rad]
    qvel: FloatArray  # (T, nv) [rad/s]
    qacc: FloatArray  # (T, nv) [rad/s^2]
    torque: FloatArray  # (T, nv) that the motors must make besides carrying the weight [N m]
    weight: FloatArray  # (T, nv) that carry the body's weight [N m]
    line: FloatArray  # (sites, 2, 3) start and end of each hand's line [m]


def straight_motion(
    body: Body,
    moves: Mapping[str, FloatArray],
    dofs: IntArray,
    duration: float,
    *,
    rest: float = 0.0,
    start: FloatArray | None = None,
) -> Motion:
    """The movement of the joints `dofs` that takes sites along straight lines.

    Args:
        body: what moves.
        moves: site -> displacement (3,) [m] of that site.
        dofs: the joints that may move; all others keep their angles.
        duration: of the movement [s].
        rest: how long the end is held after it [s].
        start: posture (nv,) at the beginning; default: home.

    Raises:
        BodyError: a line leaves what the joints can reach.
    """
    q0 = body.home[body.qpos_of_dof] if start is None else start
    follow = _Lines(body, moves, dofs)
    nodes = 0.5 - 0.5 * np.cos(np.pi * np.arange(NODES) / (NODES - 1))
    angles = [q0]
    for share in nodes[1:]:
        angles.append(follow(angles[-1], share, q0))
    path = [Chebyshev.fit(nodes, a, DEGREE, domain=[0, 1]) for a in np.transpose(angles)[dofs]]
    steps = round((duration + rest) / body.timestep)
    time: FloatArray = np.arange(steps + 1, dtype=float) * body.timestep
    s, speed, push = minimum_jerk_profile(time, duration)
    qpos, qvel, qacc = np.tile(q0, (len(time), 1)), *np.zeros((2, len(time), body.nv))
    for dof, angle in zip(dofs, path, strict=True):
        slope, bend = angle.deriv(1)(s), angle.deriv(2)(s)
        qpos[:, dof] = angle(s)
        qvel[:, dof] = slope * speed
        qacc[:, dof] = slope * push + bend * speed**2
    _check_range(body, qpos)
    total, weight = inverse_dynamics(body, qpos, qvel, qacc)
    lines = follow.lines(q0)
    return Motion(duration, time, qpos, qvel, qacc, total - weight, weight, lines)


def minimum_jerk_profile(time: FloatArray, duration: float) -> tuple[FloatArray, ...]:
    """Share of the way, its rate [1/s] and its acceleration [1/s^2], (T,) each."""
    s = np.clip(time / duration, 0.0, 1.0)
    share = s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
    rate = 30.0 * s**2 * (1.0 - s) ** 2 / duration
    push = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / duration**2
    return share, rate, push


def inverse_dynamics(
    body: Body, qpos: FloatArray, qvel: FloatArray, qacc: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Joint torques that a movement takes, without contacts.

    Args:
        body: what moves.
        qpos: joint angles (T, nv) [rad].
        qvel: (T, nv) [rad/s]
        qacc: (T, nv) [rad/s^2]

    Returns:
        The torques (T, nv) [N m] that the motors must make, and the part of them that carries
        the weight (T, nv) [N m].
    """
    model = copy.copy(body.model)
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    data = mujoco.MjData(model)
    torque, weight = np.empty_like(qpos), np.empty_like(qpos)
    for k in range(len(qpos)):
        data.qpos[body.qpos_of_dof] = qpos[k]
        data.qvel[:] = 0.0
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        weight[k] = data.qfrc_bias
        data.qvel[:], data.qacc[:] = qvel[k], qacc[k]
        mujoco.mj_inverse(model, data)
        torque[k] = data.qfrc_inverse
    return torque, weight


def site_paths(body: Body, sites: tuple[str, ...], qpos: FloatArray) -> FloatArray:
    """Where sites are [m] (sites, T, 3) in postures (T, nq)."""
    data, paths = mujoco.MjData(body.model), np.empty((len(sites), len(qpos), 3))
    for k in range(len(qpos)):
        data.qpos[:] = qpos[k]
        mujoco.mj_kinematics(body.model, data)
        for row, site in enumerate(sites):
            paths[row, k] = data.site(site).xpos
    return paths


class _Lines:
    """Inverse kinematics of sites on lines, by damped least squares.

    A joint's part of the way is in proportion to the square of its range and to the root of
    what it moves, as its servo is stiff: the arm does more than the trunk.
    """

    def __init__(self, body: Body, moves: Mapping[str, FloatArray], dofs: IntArray) -> None:
        self._body, self._dofs = body, dofs
        self._data = mujoco.MjData(body.model)
        self._sites = [body.model.site(name).id for name in moves]
        self._moves = np.array(list(moves.values()), dtype=float)
        low, high = (np.clip(limit[dofs], -np.pi, np.pi) for limit in body.range)
        stiffness = np.array([body.servo(int(dof)).stiffness for dof in dofs])
        self._ease = (high - low) ** 2 / np.sqrt(stiffness)

    def lines(self, q0: FloatArray) -> FloatArray:
        """Starts and ends (sites, 2, 3) [m]."""
        start = self._places(q0)
        return np.stack([start, start + self._moves], axis=1)

    def __call__(self, near: FloatArray, share: float, q0: FloatArray) -> FloatArray:
        """Angles (nv,), close to `near`, with every site at a share of its way."""
        goal = self._places(q0) + share * self._moves
        q = near.copy()
        for _ in range(ITERATIONS):
            miss = (goal - self._places(q)).ravel()
            J = self._jacobian()
            step = self._ease[:, None] * J.T
            square = J @ step
            square += DAMPING * np.trace(square) * np.eye(len(square))
            q[self._dofs] += step @ np.linalg.lstsq(square, miss, rcond=1e-9)[0]
            if np.abs(miss).max() < NEAR:
                return q
        name = self._body.map.name
        raise BodyError(f"{name} cannot follow the line: it misses by {np.abs(miss).max():.4f} m")

    def _places(self, q: FloatArray) -> FloatArray:
        data = self._data
        data.qpos[self._body.qpos_of_dof] = q
        mujoco.mj_kinematics(self._body.model, data)
        mujoco.mj_comPos(self._body.model, data)
        places: FloatArray = data.site_xpos[self._sites].copy()
        return places

    def _jacobian(self) -> FloatArray:
        """Of all places with respect to the joints that may move (3 sites, dofs)."""
        J = np.empty((len(self._sites), 3, self._body.nv))
        for row, site in enumerate(self._sites):
            mujoco.mj_jacSite(self._body.model, self._data, J[row], None, site)
        return J[:, :, self._dofs].reshape(-1, len(self._dofs))


def _check_range(body: Body, qpos: FloatArray) -> None:
    low, high = body.range
    outside = ((qpos < low) | (qpos > high)).any(axis=0)
    if outside.any():
        name = body.dof_name(int(np.flatnonzero(outside)[0]))
        raise BodyError(f"the line takes {name} beyond its range")
